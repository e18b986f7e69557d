//! The walks to a board and to an image of one's own.

/// The page about an image of one's own in C.
pub(crate) fn image_in_c() {
    tests::walk::through("docs/extend/drive-in-c-on-a-board.md", &[]);
}

/// The page leads there; its last command is a run that fails at a wrong wire.
pub(crate) fn own_board() {
    tests::walk::through_in_a_copy("docs/extend/board.md");
}
