"""Checks of a page in a browser: texts of plots that lie over something, and what paper cuts."""

from __future__ import annotations

from typing import Any

PAPER_PX = (688, 1017)
"""Width and height of a page A4 within its margins of 14 mm, at 96 px per inch."""

# Of each text its corners on the screen: the ink of its letters, not the height of its line.
_CORNERS = """
const corners = (text) => {
    const box = text.getBBox(), at = text.getScreenCTM(), trim = Math.min(0.5, box.width / 4);
    const [left, right] = [box.x + trim, box.x + box.width - trim];
    const [top, bottom] = [box.y + 0.18 * box.height, box.y + 0.8 * box.height];
    return [[left, top], [right, top], [right, bottom], [left, bottom]].map(([x, y]) => {
        const point = new DOMPoint(x, y).matrixTransform(at);
        return [point.x, point.y];
    });
};
const ofBox = ({left, right, top, bottom}) => [[left, top], [right, top], [right, bottom], [left, bottom]];
const named = (svg) => (svg.getAttribute("aria-label") || "").slice(0, 40);
const said = (text) => `"${text.textContent.trim()}"`;
const textsOf = (svg) =>
    [...svg.querySelectorAll("text")].filter((text) => text.textContent.trim() && text.checkVisibility());
// Two convex figures are apart if a side of one of them parts them.
const meets = (one, other) => [[one, other], [other, one]].every(([a, b]) => a.every(([x, y], i) => {
    const [nx, ny] = [a[(i + 1) % a.length][1] - y, x - a[(i + 1) % a.length][0]];
    const side = (points) => points.map(([px, py]) => nx * (px - x) + ny * (py - y));
    const [own, theirs] = [side(a), side(b)];
    return Math.max(...own) > Math.min(...theirs) && Math.max(...theirs) > Math.min(...own);
}));
"""
PLOTS = f"""(svgs) => {{
    {_CORNERS}
    const found = [];
    for (const svg of svgs) {{
        const frame = svg.getBoundingClientRect(), texts = textsOf(svg), at = texts.map(corners);
        const points = [...svg.querySelectorAll("g[clip-path] use")];
        const marks = points.map((use) => ofBox(use.getBoundingClientRect()));
        const tell = (i, what) => found.push(`${{named(svg)}}: ${{said(texts[i])}} ${{what}}`);
        at.forEach((box, i) => {{
            const out = box.some(([x, y]) =>
                x < frame.left - 1 || x > frame.right + 1 || y < frame.top - 1 || y > frame.bottom + 1);
            if (out) tell(i, "leaves the picture");
            for (let j = 0; j < i; j++)
                if (meets(box, at[j])) tell(i, `lies over ${{said(texts[j])}}`);
            if (marks.some((mark) => meets(box, mark))) tell(i, "lies over a point");
        }});
    }}
    return [...new Set(found)];
}}"""
"""Texts of plots that leave them, lie over each other or over points."""
CURVES = f"""(svgs) => {{
    {_CORNERS}
    const found = [];
    for (const svg of svgs) {{
        const texts = textsOf(svg), at = texts.map(corners);
        for (const path of svg.querySelectorAll("path[clip-path]")) {{
            const style = getComputedStyle(path), length = path.getTotalLength(), to = path.getScreenCTM();
            if (style.fill !== "none" || length === 0) continue;
            const points = Array.from({{length: 400}}, (_, k) => path.getPointAtLength(length * k / 399))
                .map((p) => p.matrixTransform(to)).map((p) => [[p.x, p.y]]);
            at.forEach((box, i) => {{
                if (points.some(([[x, y]]) => meets(box, [[x, y], [x + .2, y], [x, y + .2]])))
                    found.push(`${{named(svg)}}: ${{said(texts[i])}} lies over a line, ${{style.stroke}}`);
            }});
        }}
    }}
    return [...new Set(found)];
}}"""
"""Texts of plots that lie over lines, which may be right: names in a field of isolines."""
PAPER = """([width, height]) => {
    const found = [], tell = (node, what) => {
        const name = (node.textContent || node.getAttribute("aria-label") || "").trim().slice(0, 40);
        found.push(`${node.tagName} "${name}" ${what}`);
    };
    for (const node of document.querySelectorAll("tr, figure, svg, img, .facts div, h2, h3")) {
        if (!node.checkVisibility() || node.closest("thead")) continue;
        const box = node.getBoundingClientRect();
        if (box.height > height) tell(node, `is higher than a page: ${box.height}`);
        if (box.right > width + 1) tell(node, `is wider than the page: ${box.right}`);
        if (["TR", "FIGURE"].includes(node.tagName) && getComputedStyle(node).breakInside !== "avoid")
            tell(node, "may be broken");
    }
    return found;
}"""


def found_in_plots(page: Any, curves: bool = False) -> list[str]:
    """Return what is wrong with the pictures of a page."""
    found: list[str] = page.locator("svg").evaluate_all(CURVES if curves else PLOTS)
    return found


def found_on_paper(page: Any) -> list[str]:
    """Return what a page of paper cuts or breaks, and leave the window as wide as paper."""
    width, height = PAPER_PX
    page.set_viewport_size({"width": width, "height": height})
    page.emulate_media(media="print")
    page.evaluate("() => dispatchEvent(new Event('beforeprint'))")
    found: list[str] = page.evaluate(PAPER, [width, height])
    return found
