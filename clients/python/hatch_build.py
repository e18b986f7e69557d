"""Puts the program into the wheel that `cargo xtask dist` builds. Any other wheel has the Python package alone."""

import os
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

LIBRARY = "liblashloop_fmu.so"
COMPLETIONS = {
    "bash": "share/bash-completion/completions/lashloop",
    "zsh": "share/zsh/site-functions/_lashloop",
    "fish": "share/fish/vendor_completions.d/lashloop.fish",
}


class Programs(BuildHookInterface[Any]):
    """Adds the files of the folder `LASHLOOP_WHEEL_FILES` under the tag `LASHLOOP_WHEEL_TAG`."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add programs, man pages, completions and licences; an editable installation has none of them."""
        named = os.environ.get("LASHLOOP_WHEEL_FILES")
        if named is None or version == "editable":
            return
        files = Path(named)
        build_data["pure_python"] = False
        build_data["tag"] = os.environ["LASHLOOP_WHEEL_TAG"]
        for name in ("lashloop", "lashloop-fmu"):
            build_data["shared_scripts"][str(files / name)] = name
        shared = build_data["shared_data"]
        shared[str(files / LIBRARY)] = f"lib/lashloop/{LIBRARY}"
        for page in (files / "man").iterdir():
            shared[str(page)] = f"share/man/man1/{page.name}"
        for shell, place in COMPLETIONS.items():
            shared[str(files / "completions" / f"lashloop.{shell}")] = place
        for text in ("LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.txt"):
            shared[str(files / text)] = f"share/doc/lashloop/{text}"
