//! Figures and tables as one self-contained HTML page.

use std::fmt::Write;

use super::table::Table;
use crate::plot::Figure;
use crate::xml::Escaped;

const HEAD: &str = include_str!("page_head.html");

/// The page. `drawn_from` names the program and the device of the runs.
pub fn page(figures: &[(u8, Figure)], tables: &[Table], drawn_from: &str) -> String {
    let mut page = HEAD.to_owned();
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
