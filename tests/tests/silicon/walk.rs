//! The walk to a board of one's own.

/// The page leads there; its last command is a run that fails at a wrong wire.
pub(crate) fn own_board() {
    tests::walk::through_in_a_copy("docs/extend/board.md");
}
