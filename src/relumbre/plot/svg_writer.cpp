#include "relumbre/plot/svg_writer.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "relumbre/plot/palette.h"

namespace relumbre {

namespace {

std::string number(double value) {
  std::string text = fmt::format("{:.2f}", value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

/// Bytes of the UTF-8 sequence that begins here; 0 if it is none that XML allows.
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const bool overlong = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xf0 && byte(1) < 0x90);
  const bool surrogate = first == 0xed && byte(1) > 0x9f;
  const bool too_large = first == 0xf4 && byte(1) > 0x8f;
  const bool not_a_character = first == 0xef && byte(1) == 0xbf && byte(2) >= 0xbe;
  return overlong || surrogate || too_large || not_a_character ? 0 : length;
}

std::string_view anchor_name(Anchor anchor) {
  return anchor == Anchor::kStart ? "start" : anchor == Anchor::kMiddle ? "middle" : "end";
}

}  // namespace

std::string escape_xml(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    if (length == 0)
      out += "\uFFFD";
    else if (text[0] == '&')
      out += "&amp;";
    else if (text[0] == '<')
      out += "&lt;";
    else if (text[0] == '>')
      out += "&gt;";
    else if (text[0] == '"')
      out += "&quot;";
    else
      out += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return out;
}

double text_width(std::string_view text, double size) {
  double ems = 0;
  for (const char c : text) {
    if ((static_cast<unsigned char>(c) & 0xc0) == 0x80) continue;  // not a character's first byte
    const std::string_view narrow = "iljtf.,:;'|!()[] ", wide = "mwMWGOQ%@";
    ems += narrow.find(c) != narrow.npos ? 0.35 : wide.find(c) != wide.npos ? 0.9 : 0.6;
  }
  return ems * size;
}

void SvgWriter::line(double x0, double y0, double x1, double y1, std::string_view color,
                     double width) {
  body_ += fmt::format(R"(<line x1="{}" y1="{}" x2="{}" y2="{}" stroke="{}" stroke-width="{}"/>)",
                       number(x0), number(y0), number(x1), number(y1), color, number(width));
  body_ += '\n';
}

void SvgWriter::rectangle(double x, double y, double width, double height, std::string_view fill,
                          std::string_view stroke) {
  body_ += fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="{}" stroke="{}"/>)",
                       number(x), number(y), number(width), number(height),
                       fill.empty() ? "none" : fill, stroke.empty() ? "none" : stroke);
  body_ += '\n';
}

void SvgWriter::path(std::string_view data, std::string_view fill, std::string_view stroke,
                     double width, std::string_view dashes) {
  body_ += fmt::format(
      R"(<path d="{}" fill="{}" stroke="{}" stroke-width="{}" stroke-linejoin="round"{}/>)", data,
      fill.empty() ? "none" : fill, stroke.empty() ? "none" : stroke, number(width),
      dashes.empty() ? "" : fmt::format(R"( stroke-dasharray="{}")", dashes));
  body_ += '\n';
}

void SvgWriter::text(double x, double y, std::string_view content, const TextStyle& style) {
  const std::string turn = style.turned == 0
                               ? ""
                               : fmt::format(R"svg( transform="rotate({} {} {})")svg",
                                             number(style.turned), number(x), number(y));
  body_ +=
      fmt::format(R"(<text x="{}" y="{}" font-size="{}" text-anchor="{}" fill="{}"{}{}>{}</text>)",
                  number(x), number(y), number(style.size), anchor_name(style.anchor), style.color,
                  style.bold ? R"( font-weight="600")" : "", turn, escape_xml(content));
  body_ += '\n';
}

void SvgWriter::mark(std::size_t mark, double x, double y, double radius, std::string_view color) {
  // Corners in units of the radius; marks of equal weight to the eye.
  constexpr std::array<const char*, kMarks> kShapes{
      "",                                     // a disc
      "-.85 -.85 .85 -.85 .85 .85 -.85 .85",  // square
      "0 -1.15 1.1 .8 -1.1 .8",               // triangle
      "0 -1.25 1.25 0 0 1.25 -1.25 0",        // diamond
      "-1.1 -.8 1.1 -.8 0 1.15",              // triangle, down
      "-.4 -1.2 .4 -1.2 .4 -.4 1.2 -.4 1.2 .4 .4 .4 .4 1.2 -.4 1.2 -.4 .4 -1.2 .4 -1.2 -.4 -.4 -.4",
      "-.8 -1.15 .8 -1.15 .8 1.15 -.8 1.15",   // tall
      "-1.15 -.7 1.15 -.7 1.15 .7 -1.15 .7"};  // wide
  if (mark % kMarks == 0)
    body_ += fmt::format(R"(<circle cx="{}" cy="{}" r="{}" fill="{}"/>)", number(x), number(y),
                         number(radius), color);
  else
    body_ += fmt::format(
        R"svg(<polygon points="{}" transform="translate({} {}) scale({})" fill="{}"/>)svg",
        kShapes[mark % kMarks], number(x), number(y), number(radius), color);
  body_ += '\n';
}

std::string SvgWriter::document(double width, double height, std::string_view title) const {
  const std::string name = escape_xml(title), w = number(width), h = number(height);
  return fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" )"
                     R"(viewBox="0 0 {0} {1}" role="img" aria-label="{2}" )"
                     R"(font-family="system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif">)",
                     w, h, name) +
         "\n<title>" + name + "</title>\n" +
         fmt::format(R"(<rect width="{}" height="{}" fill="#ffffff"/>)", w, h) + "\n" + body_ +
         "</svg>\n";
}

}  // namespace relumbre
