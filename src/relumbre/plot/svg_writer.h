/// SVG elements as text. Coordinates are pixels, two decimals, whatever the locale.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace relumbre {

/// Escapes & < > " for XML and replaces what XML cannot hold: control characters, bytes that are
/// not UTF-8.
std::string escape_xml(std::string_view text);

/// About how wide a text is in a sans-serif font of this size, rather too wide than too narrow.
double text_width(std::string_view text, double size);

enum class Anchor { kStart, kMiddle, kEnd };

struct TextStyle {
  double size = 12;
  Anchor anchor = Anchor::kStart;
  double turned = 0;  ///< degrees, clockwise, about the text's place
  bool bold = false;
  std::string_view color = "#333333";
};

class SvgWriter {
 public:
  void line(double x0, double y0, double x1, double y1, std::string_view color, double width);
  void rectangle(double x, double y, double width, double height, std::string_view fill,
                 std::string_view stroke);
  /// `data` as SVG's path data; an empty color draws nothing.
  void path(std::string_view data, std::string_view fill, std::string_view stroke, double width,
            std::string_view dashes = {});
  void text(double x, double y, std::string_view content, const TextStyle& style);
  /// One of the kMarks marks.
  void mark(std::size_t mark, double x, double y, double radius, std::string_view color);

  /// The document: white, this large, with its title for those who listen.
  [[nodiscard]] std::string document(double width, double height, std::string_view title) const;

 private:
  std::string body_;
};

}  // namespace relumbre
