#include <algorithm>
#include <array>
#include <bit>
#include <charconv>

#include <fmt/format.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/experiment/plan.h"
#include "relumbre/experiment/toml_fields.h"
#include "relumbre/experiment/word_scene.h"
#include "relumbre/scene/builtin_scenes.h"

namespace relumbre {

namespace {

using toml_fields::Fields;
using toml_fields::printable;

constexpr std::size_t kMostText = std::size_t{1} << 20, kMostCells = 1'000'000, kMostName = 80;
constexpr std::int64_t kMostDepth = kMaxWordDepth, kMostTile = 65536, kMostSide = 16384,
                       kMostGts = 4096;
constexpr std::int64_t kMostLines = std::int64_t{1} << 24;
constexpr std::string_view kBuiltin = "builtin:";

/// A factor's levels, each once.
template <class T>
class Levels {
 public:
  Levels(const Fields& fields, std::string_view key) : fields_(fields), key_(key) {}

  void add(const toml::node& node, T level, const std::string& shown) {
    if (std::ranges::find(shown_, shown) != shown_.end())
      fields_.fail(node,
                   fmt::format("{}{}: {} comes twice", fields_.prefix, key_, printable(shown)));
    shown_.push_back(shown);
    levels_.push_back(std::move(level));
  }
  std::vector<T> take() { return std::move(levels_); }

 private:
  const Fields& fields_;
  std::string_view key_;
  std::vector<T> levels_;
  std::vector<std::string> shown_;
};

template <class T>
std::vector<T> read_integers(const Fields& fields, std::string_view key, const toml::node& node,
                             std::int64_t high) {
  Levels<T> levels(fields, key);
  fields.for_each(key, node, [&](const toml::node& level) {
    const std::int64_t value = fields.integer(key, level, 1, high);
    levels.add(level, static_cast<T>(value), std::to_string(value));
  });
  return levels.take();
}

/// All of `text` as a number of at most 9 digits.
std::optional<std::uint32_t> parse_number(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || text.size() > 9) return {};
  return value;
}

Resolution read_resolution(const Fields& fields, const toml::node& node) {
  const std::string text = fields.text("resolution", node);
  const std::size_t cross = std::min(text.find('x'), text.size());
  const auto width = parse_number(std::string_view(text).substr(0, cross));
  const auto height = parse_number(std::string_view(text).substr(std::min(cross + 1, text.size())));
  if (!width || !height)
    fields.fail(node,
                fmt::format("factors.resolution: \"{}\" is not like \"640x480\"", printable(text)));
  for (const std::uint32_t side : {*width, *height})
    if (side < 1 || side > kMostSide)
      fields.fail(node, fmt::format("factors.resolution: {} has a side not from 1 to {}",
                                    printable(text), kMostSide));
  return {*width, *height};
}

std::vector<Resolution> read_resolutions(const Fields& fields) {
  Levels<Resolution> levels(fields, "resolution");
  fields.for_each("resolution", fields.require("resolution"), [&](const toml::node& node) {
    const Resolution resolution = read_resolution(fields, node);
    levels.add(node, resolution, to_string(resolution));
  });
  return levels.take();
}

/// Throws FileError, naming the file that is missing.
std::filesystem::path existing_file(const Fields& fields, const toml::node& node,
                                    const std::filesystem::path& folder, const std::string& name) {
  if (name.empty() || name.find('\0') != name.npos)
    fields.fail(node, fmt::format("\"{}\" is no file name", printable(name)));
  std::filesystem::path path = folder / std::filesystem::path(name);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    fields.fail(node, fmt::format("{}: there is no such file", printable(path.string())));
  return path;
}

std::string default_name(const std::string& source) {
  if (source.starts_with(kBuiltin)) return source.substr(kBuiltin.size());
  return std::filesystem::path(source).stem().string();
}

void check_name(const Fields& fields, const toml::node& node, const std::string& name) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (name.empty() || name.size() > kMostName || std::ranges::any_of(name, is_control))
    fields.fail(node, fmt::format("factors.scenes: \"{}\" is no name of 1 to {} bytes",
                                  printable(name), kMostName));
}

void check_builtin(const Fields& fields, const toml::node& node, const std::string& name) {
  if (std::ranges::find(builtin_scenes(), name, &BuiltinScene::name) == builtin_scenes().end())
    fields.fail(node,
                fmt::format("factors.scenes: there is no built-in scene \"{}\"", printable(name)));
}

/// "builtin:NAME", a path, or {name = "…", mesh = one of these}.
PlannedScene read_scene(const Fields& fields, const toml::node& node,
                        const std::filesystem::path& folder) {
  PlannedScene scene;
  const toml::node* source = &node;
  const toml::node* name = nullptr;
  if (const toml::table* table = node.as_table()) {
    const Fields own{*table, "factors.scenes.", fields.file};
    own.allow_only(std::array<std::string_view, 2>{"name", "mesh"});
    source = &own.require("mesh");
    name = own.find("name");
  }
  scene.source = fields.text("scenes", *source);
  scene.name = name != nullptr ? fields.text("scenes.name", *name) : default_name(scene.source);
  check_name(fields, name != nullptr ? *name : *source, scene.name);
  if (scene.source.starts_with(kBuiltin)) {
    scene.builtin = scene.source.substr(kBuiltin.size());
    check_builtin(fields, *source, scene.builtin);
  } else {
    scene.mesh = existing_file(fields, *source, folder, scene.source);
  }
  return scene;
}

std::vector<PlannedScene> read_scenes(const Fields& fields, const std::filesystem::path& folder) {
  Levels<PlannedScene> levels(fields, "scenes");
  fields.for_each("scenes", fields.require("scenes"), [&](const toml::node& node) {
    PlannedScene scene = read_scene(fields, node, folder);
    const std::string name = scene.name;
    levels.add(node, std::move(scene), name);
  });
  return levels.take();
}

PlannedTraversal read_traversal(const Fields& fields, const toml::node& node) {
  constexpr std::string_view kShort = "short-stack(";
  const std::string text = fields.text("traversal", node);
  if (text == "gt") return {};
  if (text == "restart") return Traversal{Traversal::Kind::kRestart};
  if (text == "backtrack") return Traversal{Traversal::Kind::kBacktrack};
  if (text == "full-stack") return Traversal{Traversal::Kind::kFullStack};
  if (text.starts_with(kShort) && text.ends_with(")")) {
    const auto nodes =
        parse_number(std::string_view(text).substr(kShort.size(), text.size() - kShort.size() - 1));
    if (nodes && *nodes >= 1 && *nodes <= kMostDepth)
      return Traversal{Traversal::Kind::kShortStack, static_cast<int>(*nodes)};
  }
  fields.fail(node, fmt::format("machine.traversal: \"{}\" is none of gt, restart, backtrack, "
                                "full-stack, short-stack(1) to short-stack({})",
                                printable(text), kMostDepth));
}

std::vector<PlannedTraversal> read_traversals(const Fields& fields, const toml::node& node) {
  Levels<PlannedTraversal> levels(fields, "traversal");
  fields.for_each("traversal", node, [&](const toml::node& level) {
    const PlannedTraversal traversal = read_traversal(fields, level);
    levels.add(level, traversal, to_string(traversal));
  });
  return levels.take();
}

std::uint64_t read_ways(const Fields& fields, const toml::node& node,
                        const std::vector<std::uint64_t>& lines) {
  if (node.is_string()) {
    if (fields.text("ways", node) == "full") return 0;
    fields.fail(node, "machine.ways: \"full\" is the only word for it");
  }
  const auto least = static_cast<std::int64_t>(std::ranges::min(lines));
  const auto ways = static_cast<std::uint64_t>(fields.integer("ways", node, 1, least));
  if (!std::has_single_bit(ways))
    fields.fail(node, fmt::format("machine.ways: {} is no power of two", ways));
  return ways;
}

Replacement read_replacement(const Fields& fields, const toml::node& node) {
  const std::string text = fields.text("replacement", node);
  for (const auto replacement : {Replacement::kLru, Replacement::kFifo, Replacement::kRandom})
    if (text == to_string(replacement)) return replacement;
  fields.fail(node, fmt::format("machine.replacement: \"{}\" is none of lru, fifo, random",
                                printable(text)));
}

/// Caches that take some of the address' bits as their index have a power of two of lines.
void check_lines(const Fields& fields, const ExperimentPlan& plan) {
  if (plan.ways == 0) return;
  std::size_t i = 0;
  fields.for_each("lines", fields.require("lines"), [&](const toml::node& node) {
    if (!std::has_single_bit(plan.lines[i]))
      fields.fail(node, fmt::format("factors.lines: {} is no power of two", plan.lines[i]));
    ++i;
  });
}

void read_factors(const Fields& fields, const std::filesystem::path& folder, ExperimentPlan& plan) {
  fields.allow_only(
      std::array<std::string_view, 5>{"scenes", "depth", "tile", "lines", "resolution"});
  plan.scenes = read_scenes(fields, folder);
  plan.depths = read_integers<std::uint32_t>(fields, "depth", fields.require("depth"), kMostDepth);
  plan.tiles = read_integers<std::uint32_t>(fields, "tile", fields.require("tile"), kMostTile);
  plan.lines = read_integers<std::uint64_t>(fields, "lines", fields.require("lines"), kMostLines);
  plan.resolutions = read_resolutions(fields);
}

void read_machine(const Fields& fields, const std::filesystem::path& folder, ExperimentPlan& plan) {
  fields.allow_only(std::array<std::string_view, 6>{"gts", "traversal", "separating", "camera",
                                                    "ways", "replacement"});
  if (const toml::node* node = fields.find("gts"))
    plan.gts = read_integers<std::uint32_t>(fields, "gts", *node, kMostGts);
  if (const toml::node* node = fields.find("traversal"))
    plan.traversals = read_traversals(fields, *node);
  if (const toml::node* node = fields.find("separating")) {
    plan.separating = static_cast<int>(fields.integer("separating", *node, 6, 26));
    if (plan.separating != 6 && plan.separating != 26)
      fields.fail(*node,
                  fmt::format("machine.separating: {} is neither 6 nor 26", plan.separating));
  }
  if (const toml::node* node = fields.find("camera")) {
    plan.camera = fields.text("camera", *node);
    if (plan.camera != "auto") plan.camera_file = existing_file(fields, *node, folder, plan.camera);
  }
  if (const toml::node* node = fields.find("ways"))
    plan.ways = read_ways(fields, *node, plan.lines);
  if (const toml::node* node = fields.find("replacement"))
    plan.replacement = read_replacement(fields, *node);
}

/// The product of the factors, which must not overflow meanwhile.
void check_cells(const Fields& fields, const ExperimentPlan& plan) {
  std::size_t cells = 1;
  for (const std::size_t levels :
       {plan.scenes.size(), plan.depths.size(), plan.tiles.size(), plan.lines.size(),
        plan.resolutions.size(), plan.gts.size(), plan.traversals.size()}) {
    cells *= levels;
    if (cells > kMostCells)
      throw FileError(fields.file, fmt::format("the plan has more than {} cells", kMostCells));
  }
}

/// The table of this name; `empty` if there is none.
const toml::table& section(const Fields& root, std::string_view name, const toml::table& empty) {
  const toml::node* node = root.find(name);
  if (node == nullptr) return empty;
  if (!node->is_table()) root.fail(*node, fmt::format("{} is no table: write [{}]", name, name));
  return *node->as_table();
}

}  // namespace

ExperimentPlan parse_plan(std::string_view text, const std::string& file_name,
                          const std::filesystem::path& folder) {
  if (text.size() > kMostText)
    throw FileError(file_name, fmt::format("{} bytes, at most {}", text.size(), kMostText));
  const toml::table root = toml_fields::parse(text, file_name), empty;
  const Fields top{root, "", file_name};
  top.allow_only(std::array<std::string_view, 3>{"title", "factors", "machine"});
  ExperimentPlan plan;
  if (const toml::node* title = top.find("title")) plan.title = top.text("title", *title);
  (void)top.require("factors");
  const Fields factors{section(top, "factors", empty), "factors.", file_name};
  read_factors(factors, folder, plan);
  read_machine({section(top, "machine", empty), "machine.", file_name}, folder, plan);
  check_lines(factors, plan);
  check_cells(top, plan);
  return plan;
}

ExperimentPlan read_plan(const std::filesystem::path& file) {
  return parse_plan(read_file(file, kMostText), file.string(), file.parent_path());
}

}  // namespace relumbre
