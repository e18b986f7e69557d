//! The figures and tables as one page that needs nothing but itself.

use std::fmt::Write;

use super::table::Table;
use crate::plot::Figure;
use crate::xml::Escaped;

const HEAD: &str = r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>The paper's figures, paper and here</title>
<style>
body { font-family: Helvetica, Arial, sans-serif; color: #1c2430; background: #fff; max-width: 66rem; margin: 2rem auto; padding: 0 1rem; line-height: 1.45; }
svg { max-width: 100%; height: auto; }
figure { margin: 2rem 0; }
figcaption { color: #55606d; font-size: .9rem; }
nav a { margin-right: .7rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: 1rem 0 2rem; }
caption { text-align: left; font-weight: bold; padding-bottom: .4rem; }
th, td { padding: .2rem .8rem .2rem 0; border-bottom: 1px solid #e8ebef; text-align: right; white-space: nowrap; }
th:first-child { text-align: left; font-weight: normal; }
</style>
</head>
<body>
<h1>The paper's figures, paper and here</h1>
<p>R. Merzouki and J. C. Cadiou, "Estimation of backlash phenomenon in the electromechanical actuator", Control Engineering
Practice 13 (2005) 973-983, <a href="https://doi.org/10.1016/j.conengprac.2004.10.016">doi:10.1016/j.conengprac.2004.10.016</a>.
"Before" is the cascaded PD law, "after" adds the paper's compensation, "beyond" is a law that inverts the gap in the torque
domain. Each figure says what the paper shows and what comes out here, also where that is something else.</p>
"#;

/// The page. `drawn_from` says which runs were made and on what.
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

/// Where a figure stands beside the page.
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
