//! Figures and tables as one self-contained HTML page.

use std::fmt::Write;

use super::table::Table;
use lashloop_plot::Figure;
use lashloop_plot::xml::Escaped;

const HEAD: &str = include_str!("page_head.html");

/// Title and introduction of a page.
#[derive(Debug, Clone, Copy)]
pub struct Head {
    title: &'static str,
    introduction: &'static str,
}

/// Of the figures of three laws.
pub const PAPER: Head = Head {
    title: "The paper's figures, paper and here",
    introduction: "\"Before\" is the cascaded PD law, \"after\" adds the paper's compensation, \"beyond\" is a law that inverts the gap in the torque
domain. Each caption states the paper's result and ours, also where they differ.",
};

/// Of simulation and experiment.
pub const COMPARISON: Head = Head {
    title: "Simulation and experiment",
    introduction: "\"Before\" is the cascaded PD law, \"after\" adds the paper's compensation. The simulation is the run in HIL mode, the
experiment the run of the same scenario in bench mode, in which the drive reads its own encoders and commands its power stage.",
};

/// The page. `drawn_from` names the program and the device of the runs.
pub fn page(head: &Head, figures: &[(u8, Figure)], tables: &[Table], drawn_from: &str) -> String {
    let mut page = HEAD.replace("{title}", head.title).replace("{introduction}", head.introduction);
    let links = figures.iter().map(|(number, _)| format!("<a href=\"#figure-{number:02}\">{number}</a>"));
    push(&mut page, format_args!("<nav>Figures: {}</nav>\n", links.collect::<String>()));
    for table in tables {
        push_table(&mut page, table);
    }
    for (number, figure) in figures {
        let file = file_name(*number);
        push(
            &mut page,
            format_args!(
                "<figure id=\"figure-{number:02}\">\n<div class=\"scroll\">{}</div>\n\
                 <figcaption>Figure {number} as a file: <a href=\"{file}\">{file}</a></figcaption>\n</figure>\n",
                figure.to_svg()
            ),
        );
    }
    push(&mut page, format_args!("<p>{}</p>\n</body>\n</html>\n", Escaped(drawn_from)));
    page
}

/// File name of a figure, next to the page.
pub fn file_name(number: u8) -> String {
    format!("figure-{number:02}.svg")
}

fn push_table(page: &mut String, table: &Table) {
    push(
        page,
        format_args!(
            "<div class=\"scroll\"><table>\n<caption>{}</caption>\n<tr><th></th>",
            Escaped(table.title)
        ),
    );
    for name in &table.columns {
        push(page, format_args!("<th scope=\"col\">{}</th>", Escaped(name)));
    }
    for (what, cells) in &table.rows {
        push(page, format_args!("</tr>\n<tr><th scope=\"row\">{}</th>", Escaped(what)));
        for cell in cells {
            push(page, format_args!("<td>{}</td>", Escaped(cell)));
        }
    }
    page.push_str("</tr>\n</table></div>\n");
}

fn push(page: &mut String, text: std::fmt::Arguments) {
    page.write_fmt(text).expect("writing to a string succeeds");
}
