use crate::escape;

/// The frame of every page: head, style, body, data and script in one file.
///
/// The content policy in the head lets the page run its own script and style and load nothing: a page that
/// says "no network" should not have to be believed.
#[derive(Clone, Debug, Default)]
pub struct Shell<'a> {
    /// The title, as text.
    pub title: &'a str,
    /// Style sheets beyond the base one, in order.
    pub styles: &'a [&'a str],
    /// The body, as HTML.
    pub body: String,
    /// Script elements that carry data, as HTML ([`crate::Packed::element`]).
    pub data: String,
    /// Scripts, joined in order into one module.
    pub scripts: &'a [&'a str],
}

const BASE_STYLE: &str = include_str!("../assets/css/base.css");

impl Shell<'_> {
    /// The page.
    pub fn html(&self) -> String {
        let title = escape(self.title);
        let styles = self.styles.concat();
        let script = match self.scripts {
            [] => String::new(),
            scripts => format!("<script type=\"module\">\n{}</script>\n", scripts.concat()),
        };
        let Self { body, data, .. } = self;
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; \
             script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n\
             <title>{title}</title>\n<style>\n{BASE_STYLE}{styles}</style>\n</head>\n<body>\n\
             {body}\n{data}{script}</body>\n</html>\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_names_its_title_and_loads_nothing() {
        let page = Shell { title: "a < b", body: "<p>hi</p>".into(), ..Shell::default() }.html();
        assert!(page.contains("<title>a &lt; b</title>"));
        assert!(page.contains("default-src 'none'"));
        assert!(!page.contains("type=\"module\""));
        assert!(!page.contains("src=\"") && !page.contains("@import") && !page.contains("href=\"http"));
    }
}
