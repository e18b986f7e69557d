//! What a plot shows, as data. Colours, sizes and positions are decided when it is rendered.

/// Meaning of a curve or a mark; it determines colour and dash.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The run without compensation.
    Before,
    /// The run with compensation.
    After,
    /// A reference, drawn dashed.
    Reference,
    /// A limit, drawn dotted.
    Limit,
    /// One of several peers; the number selects the colour. Numbers 3 to 5 repeat the colours, dashed.
    Other(usize),
    /// A line of a chosen colour and dash, by number; dash 0 is solid. Further numbers repeat.
    Line {
        /// Number of the colour.
        colour: usize,
        /// Number of the dash.
        dash: usize,
    },
}

impl Role {
    /// Distinct colours of [`Role::Line`].
    pub const COLOURS: usize = 5;
}

/// One curve: the points `(x[i], y[i])` joined in order.
///
/// A point with a NaN or infinite coordinate breaks the curve. A coordinate without a partner is ignored.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// Meaning of the curve.
    pub role: Role,
    /// Horizontal coordinates in the unit of the panel's axis, in any order.
    pub x: Vec<f64>,
    /// Vertical coordinates in the unit of the panel's axis.
    pub y: Vec<f64>,
    /// Deviation of each `y`, shaded on both sides of the curve; empty for none.
    pub deviation: Vec<f64>,
}

impl Series {
    /// A curve through `(x[i], y[i])`.
    pub fn new(label: impl Into<String>, role: Role, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self { label: label.into(), role, x, y, deviation: Vec::new() }
    }

    /// Shades `y[i]` ± `deviation[i]`.
    #[must_use]
    pub fn deviation(mut self, deviation: Vec<f64>) -> Self {
        self.deviation = deviation;
        self
    }

    /// Lower and upper edge of the shade; without points if there is none.
    pub(crate) fn edges(&self) -> [Vec<f64>; 2] {
        [-1.0, 1.0].map(|side| {
            self.y.iter().zip(&self.deviation).map(|(y, deviation)| y + side * deviation).collect()
        })
    }
}

/// Quantity, unit and scale of an axis.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Axis {
    /// Name of the quantity, such as `load position`.
    pub quantity: String,
    /// Its unit, such as `rad`; empty for a pure number.
    pub unit: String,
    /// Whether equal ratios are equal lengths; on the horizontal axis only. A value that isn't above zero isn't drawn.
    pub is_logarithmic: bool,
}

impl Axis {
    /// An axis for `quantity` in `unit`.
    pub fn new(quantity: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { quantity: quantity.into(), unit: unit.into(), is_logarithmic: false }
    }

    /// The same axis with a logarithmic scale.
    #[must_use]
    pub fn logarithmic(self) -> Self {
        Self { is_logarithmic: true, ..self }
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

/// A marked point, such as the instant at which a run settles.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Text at the point.
    pub label: String,
    /// Role of the curve it belongs to.
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
    /// Curves, from back to front.
    pub series: Vec<Series>,
    /// Band of allowed values.
    pub band: Option<Band>,
    /// Marked points.
    pub marks: Vec<Mark>,
}

impl Panel {
    /// An empty diagram.
    pub fn new(title: impl Into<String>, x_axis: Axis, y_axis: Axis) -> Self {
        Self { title: title.into(), x_axis, y_axis, series: Vec::new(), band: None, marks: Vec::new() }
    }

    /// The panel with the coordinate along its horizontal axis instead of the value: the logarithm on a logarithmic one.
    pub(crate) fn along_its_axis(&self) -> Self {
        let mut panel = self.clone();
        if self.x_axis.is_logarithmic {
            let marks = panel.marks.iter_mut().map(|mark| &mut mark.x);
            let points = panel.series.iter_mut().flat_map(|series| &mut series.x);
            marks.chain(points).for_each(|x| *x = x.log10());
        }
        panel
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
    /// Caption below the diagrams, also for screen readers. A line feed starts a paragraph.
    pub caption: String,
    /// Diagrams per row; zero counts as one.
    pub columns: usize,
    /// The diagrams, row by row.
    pub panels: Vec<Panel>,
}

impl Figure {
    /// A figure without diagrams, for `columns` of them per row.
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
