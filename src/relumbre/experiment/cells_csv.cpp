#include "relumbre/experiment/cells_csv.h"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"

namespace relumbre {

namespace {

constexpr std::size_t kMostText = std::size_t{1} << 30;
constexpr std::uint32_t kMostDepth = 20;
constexpr std::array kNames{"scene", "depth", "width", "height", "traversal", "gts",
                            "tile",  "lines", "tasks", "reads",  "M",         "L"};
constexpr std::array kLevelNames{"reads", "hits", "replacements", "lines_used"};

std::string header(std::size_t levels) {
  std::string line;
  for (const char* name : kNames) line += std::string(line.empty() ? "" : ",") + name;
  for (std::size_t n = 0; n < levels; ++n)
    for (const char* name : kLevelNames) line += fmt::format(",{}_{}", name, n);
  return line;
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"") == text.npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string line_of(const ExperimentCell& cell, std::size_t levels) {
  std::string line =
      fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}", quoted(cell.scene), cell.depth, cell.width,
                  cell.height, quoted(cell.traversal), cell.gts, cell.tile, cell.lines, cell.tasks,
                  cell_reads(cell), cell_fetches(cell), cell_hit_rate(cell));
  for (const CellLevel& level : cell.levels)
    line +=
        fmt::format(",{},{},{},{}", level.reads, level.hits, level.replacements, level.lines_used);
  line.append(kLevelNames.size() * (levels - cell.levels.size()), ',');
  return line;
}

/// One line's fields, taken one after the other.
class LineReader {
 public:
  LineReader(std::string_view line, const std::string& file, std::size_t number)
      : line_(line), file_(file), number_(number) {}

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(file_, number_, reason);
  }
  [[nodiscard]] bool at_end() const { return ended_; }

  std::string text() {
    if (ended_) fail("the line is too short");
    std::string field = line_.starts_with('"') ? take_quoted() : take_plain();
    if (line_.empty())
      ended_ = true;
    else
      line_.remove_prefix(1);
    return field;
  }

  template <class T>
  T number(const char* name) {
    const std::string field = text();
    T value{};
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size())
      fail(fmt::format("{}: \"{:.40}\" is no number that it can be", name, field));
    return value;
  }

 private:
  std::string take_plain() {
    const std::size_t end = std::min(line_.find(','), line_.size());
    std::string field(line_.substr(0, end));
    line_.remove_prefix(end);
    return field;
  }

  std::string take_quoted() {
    std::string field;
    for (std::size_t at = 1; at < line_.size(); ++at) {
      if (line_[at] == '"') {
        const bool doubled = at + 1 < line_.size() && line_[at + 1] == '"';
        if (!doubled) {
          line_.remove_prefix(at + 1);
          if (!line_.empty() && line_[0] != ',') fail("text after a quote");
          return field;
        }
        ++at;
      }
      field += line_[at];
    }
    fail("a quote does not end");
  }

  std::string_view line_;
  const std::string& file_;
  std::size_t number_;
  bool ended_ = false;
};

void read_levels(LineReader& reader, ExperimentCell& cell) {
  for (std::uint32_t n = 0; n < cell.depth; ++n) {
    CellLevel level;
    level.reads = reader.number<std::uint64_t>("reads of a level");
    level.hits = reader.number<std::uint64_t>("hits of a level");
    level.replacements = reader.number<std::uint64_t>("replacements of a level");
    level.lines_used = reader.number<std::uint64_t>("lines used of a level");
    if (level.hits > level.reads) reader.fail(fmt::format("level {} has more hits than reads", n));
    cell.levels.push_back(level);
  }
  while (!reader.at_end())
    if (!reader.text().empty()) reader.fail("a level that the octree does not have");
}

ExperimentCell read_cell(LineReader reader, std::size_t levels) {
  ExperimentCell cell;
  cell.scene = reader.text();
  cell.depth = reader.number<std::uint32_t>("depth");
  cell.width = reader.number<std::uint32_t>("width");
  cell.height = reader.number<std::uint32_t>("height");
  cell.traversal = reader.text();
  cell.gts = reader.number<std::uint32_t>("gts");
  cell.tile = reader.number<std::uint32_t>("tile");
  cell.lines = reader.number<std::uint64_t>("lines");
  cell.tasks = reader.number<std::uint64_t>("tasks");
  const auto reads = reader.number<std::uint64_t>("reads");
  const auto fetches = reader.number<std::uint64_t>("M");
  const auto hit_rate = reader.number<double>("L");
  if (cell.depth > levels) reader.fail(fmt::format("depth {} without its levels", cell.depth));
  read_levels(reader, cell);
  if (reads != cell_reads(cell) || fetches != cell_fetches(cell) || hit_rate != cell_hit_rate(cell))
    reader.fail("reads, M or L are not those of the levels");
  return cell;
}

/// Takes the first line off the text, without its end.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace

std::string cells_to_csv(std::span<const ExperimentCell> cells) {
  std::size_t levels = 0;
  for (const ExperimentCell& cell : cells) levels = std::max(levels, cell.levels.size());
  std::string text = header(levels) + "\n";
  for (const ExperimentCell& cell : cells) text += line_of(cell, levels) + "\n";
  return text;
}

std::vector<ExperimentCell> parse_cells_csv(std::string_view text, const std::string& file) {
  if (text.size() > kMostText) throw FileError(file, "the table exceeds 1 GiB");
  const std::string_view names = next_line(text);
  std::size_t levels = 0;
  while (levels < kMostDepth && header(levels) != names) ++levels;
  if (header(levels) != names) throw FileError(file, 1, "this is no table of cells");
  std::vector<ExperimentCell> cells;
  for (std::size_t number = 2; !text.empty(); ++number)
    cells.push_back(read_cell({next_line(text), file, number}, levels));
  return cells;
}

std::vector<ExperimentCell> read_cells_csv(const std::filesystem::path& file) {
  return parse_cells_csv(read_file(file, kMostText), file.string());
}

}  // namespace relumbre
