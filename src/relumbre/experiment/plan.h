/// What an experiment runs: every combination of the levels of its factors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "relumbre/archsim/cache.h"
#include "relumbre/octree/traverse.h"

namespace relumbre {

struct PlannedScene {
  std::string name;            ///< in tables and figures; unique
  std::string source;          ///< as the plan has it: "builtin:NAME" or a path
  std::string builtin;         ///< NAME, or empty
  std::filesystem::path mesh;  ///< empty for a built-in scene
};

struct Resolution {
  std::uint32_t width = 0, height = 0;
  friend bool operator==(const Resolution&, const Resolution&) = default;
};
/// "640x480"
std::string to_string(const Resolution& resolution);

/// Whose reads the caches see: none, the machine's own geometry unit; else one of the survey's.
using PlannedTraversal = std::optional<Traversal>;
/// "gt", "restart", "backtrack", "full-stack", "short-stack(8)"
std::string to_string(const PlannedTraversal& traversal);

/// "lru", "fifo", "random"
std::string to_string(Replacement replacement);

struct ExperimentPlan {
  std::string title = "Experiment";
  // The factors. None is empty, no level comes twice.
  std::vector<PlannedScene> scenes;
  std::vector<std::uint32_t> depths, tiles;
  std::vector<std::uint64_t> lines;
  std::vector<Resolution> resolutions;
  std::vector<std::uint32_t> gts{1};
  std::vector<PlannedTraversal> traversals{PlannedTraversal{}};
  // What is the same for every cell.
  int separating = 26;                ///< or 6: how surfaces become voxels
  std::string camera = "auto";        ///< as the plan has it: "auto" or a path
  std::filesystem::path camera_file;  ///< empty: automatic
  std::uint64_t ways = 1;             ///< of the caches; 0: fully associative
  Replacement replacement = Replacement::kLru;
};

/// One cell: an index into each factor.
struct PlannedCell {
  std::size_t scene = 0, depth = 0, resolution = 0, traversal = 0, gts = 0, tile = 0, lines = 0;
  friend bool operator==(const PlannedCell&, const PlannedCell&) = default;
};

/// Reads a plan in TOML:
///
///     title = "Depth against cache lines"
///
///     [factors]                      # each a list, or a single level
///     scenes = ["builtin:teapots", "bunny.ply", {name = "dragon", mesh = "dragon_q11.ply"}]
///     depth = [5, 6, 7]              # 1…13
///     tile = [2, 10]                 # 1…65536 pixels
///     lines = [512, 4096]            # 1…2^24, powers of two unless ways = "full"
///     resolution = ["640x480"]       # sides 1…16384
///
///     [machine]                      # optional, as is each of its keys
///     gts = 1                        # 1…4096; may be a list
///     traversal = "gt"               # restart, backtrack, full-stack, short-stack(N), or a list
///     separating = 26                # or 6
///     camera = "auto"                # or a cam.json
///     ways = 1                       # a power of two up to the least of `lines`, or "full"
///     replacement = "lru"            # or fifo, random
///
/// Paths are relative to the plan's folder. A scene's name is that of its file or built-in scene
/// unless given. Text of up to 1 MiB, factors of up to 1,000 levels, up to a million cells.
/// Throws FileError "FILE:LINE: reason" that names the key or the level: no TOML, an unknown or a
/// missing key, a wrong type, an empty factor, a level twice or out of range, a built-in scene that
/// there is not, a mesh or a camera that is no file.
ExperimentPlan read_plan(const std::filesystem::path& file);

/// The same of text; paths start from `folder`.
ExperimentPlan parse_plan(std::string_view text, const std::string& file_name,
                          const std::filesystem::path& folder);

/// The product of the factors' numbers of levels.
std::size_t cell_count(const ExperimentPlan& plan);

/// Cell number `index`, index < cell_count. The last of these changes fastest: scene,
/// depth, resolution, traversal, gts, tile, lines; so that cells of one traversal of an octree are
/// neighbours, and among them those that one pass over it can simulate.
PlannedCell cell_at(const ExperimentPlan& plan, std::size_t index);

/// The plan in words that differ if and only if the cells or what they run on do; one "key: levels"
/// a line. Comments, order of keys, the title and paths' folders do not matter.
std::string canonical_text(const ExperimentPlan& plan);

}  // namespace relumbre
