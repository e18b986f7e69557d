//! What a plot shows, as data. Colours, sizes and positions are decided when it is rendered.

/// What a curve or a mark stands for; it decides colour and dash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The run without compensation.
    Before,
    /// The run with compensation.
    After,
    /// A value to be followed or compared with, drawn dashed.
    Reference,
    /// A value not to be exceeded, drawn dotted.
    Limit,
    /// One of several equals; the number picks the colour. After three colours the next three are dashed.
    Other(usize),
}

/// One curve: the points `(x[i], y[i])` joined in order.
///
/// A point with a NaN or infinite coordinate breaks the curve; a coordinate without a partner is left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// What the curve stands for.
    pub role: Role,
    /// Horizontal coordinates, in the unit of the panel's horizontal axis. They need not rise.
    pub x: Vec<f64>,
    /// Vertical coordinates, in the unit of the panel's vertical axis.
    pub y: Vec<f64>,
}

impl Series {
    /// A curve through `(x[i], y[i])`.
    pub fn new(label: impl Into<String>, role: Role, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { label: label.into(), role, x, y }
    }
}

/// What an axis measures.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// Name of the quantity, such as `load position`.
    pub quantity: String,
    /// Its unit, such as `rad`; empty for a pure number.
    pub unit: String,
}

impl Axis {
    /// An axis for `quantity` in `unit`.
    pub fn new(quantity: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { quantity: quantity.into(), unit: unit.into() }
    }
}

/// A horizontal band of allowed values, shaded behind the curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Name in the legend.
    pub label: String,
    /// Lower edge, in the unit of the vertical axis.
    pub low: f64,
    /// Upper edge, in the unit of the vertical axis.
    pub high: f64,
}

/// A point worth pointing at, such as the instant a run has settled.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// What to read there.
    pub label: String,
    /// Whose point it is.
    pub role: Role,
    /// Horizontal position, in the unit of the horizontal axis.
    pub x: f64,
    /// Vertical position, in the unit of the vertical axis.
    pub y: f64,
}

/// One diagram.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Heading of the diagram.
    pub title: String,
    /// Horizontal axis.
    pub x_axis: Axis,
    /// Vertical axis.
    pub y_axis: Axis,
    /// The curves; later ones lie on top.
    pub series: Vec<Series>,
    /// Band of allowed values, if there is one.
    pub band: Option<Band>,
    /// Marked points.
    pub marks: Vec<Mark>,
}

impl Panel {
    /// An empty diagram.
    pub fn new(title: impl Into<String>, x_axis: Axis, y_axis: Axis) -> Self {
        Self { title: title.into(), x_axis, y_axis, series: Vec::new(), band: None, marks: Vec::new() }
    }

    /// Adds a curve.
    #[must_use]
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Shades the values from `low` to `high`.
    #[must_use]
    pub fn band(mut self, label: impl Into<String>, low: f64, high: f64) -> Self {
        self.band = Some(Band { label: label.into(), low, high });
        self
    }

    /// Marks the point `(x, y)`.
    #[must_use]
    pub fn mark(mut self, label: impl Into<String>, role: Role, x: f64, y: f64) -> Self {
        self.marks.push(Mark { label: label.into(), role, x, y });
        self
    }
}

/// A grid of diagrams under one title.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Heading of the figure.
    pub title: String,
    /// What to see in it; set below the diagrams and read out by screen readers. A line feed starts a paragraph.
    pub caption: String,
    /// Diagrams per row; zero counts as one.
    pub columns: usize,
    /// The diagrams, row by row.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// A figure without diagrams yet, with `columns` of them per row.
    pub fn new(title: impl Into<String>, caption: impl Into<String>, columns: usize) -> Self {
        Self { title: title.into(), caption: caption.into(), columns, panels: Vec::new() }
    }

    /// Adds a diagram.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }
}
