#include "relumbre/dof/picture_channels.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

using Names = std::vector<std::string>;

constexpr std::string_view kCombined = "Combined.";
constexpr std::string_view kDepths[] = {"Depth.Z", "depth.Z", "Depth.V", "depth.V"};

std::string names_of(const Image& image) {
  Names names;
  for (const auto& channel : image.channels()) names.push_back(channel.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// What is before `end`, if the name ends so.
std::string without(const std::string& name, std::string_view end) {
  return name.ends_with(end) ? name.substr(0, name.size() - end.size()) : name;
}

/// "ViewLayer." of "ViewLayer.Combined.", "beauty." of "beauty.".
std::string layer_of_color(const std::string& prefix) { return without(prefix, kCombined); }

/// "ViewLayer." of "ViewLayer.Depth.Z", nothing of "Z".
std::string layer_of_depth(const std::string& channel) {
  for (const std::string_view end : kDepths)
    if (channel.ends_with(end)) return without(channel, end);
  return without(channel, "Z");
}

/// Prefixes of channels that end so and have R, G and B.
Names colors_ending(const Image& image, std::string_view end) {
  Names prefixes;
  for (const auto& channel : image.channels()) {
    if (!channel.name.ends_with(end) || channel.name.starts_with("layer1.")) continue;
    const std::string prefix = without(channel.name, "R");
    if (has_color(image, prefix)) prefixes.push_back(prefix);
  }
  return prefixes;
}

/// The plain one first, then Blender's, whose other passes (AO, DiffCol) are colours too, then the
/// first layer that has R, G and B.
Names color_candidates(const Image& image) {
  if (has_color(image, "")) return {""};
  Names colors = colors_ending(image, "Combined.R");
  if (!colors.empty()) return colors;
  colors = colors_ending(image, ".R");
  if (colors.size() > 1) colors.resize(1);
  return colors;
}

Names depth_candidates(const Image& image) {
  Names depths;
  if (image.has("Z")) depths.push_back("Z");
  for (const auto& channel : image.channels()) {
    const auto ends = [&](std::string_view end) { return channel.name.ends_with(end); };
    if (std::ranges::any_of(kDepths, ends)) depths.push_back(channel.name);
  }
  return depths;
}

bool layer_has_color(const Image& image, const std::string& layer) {
  return has_color(image, layer) || has_color(image, layer + std::string(kCombined));
}

/// Depth of the colour's own layer; else that of a layer that has no colour, which is nobody
/// else's.
Names depths_for(const Image& image, const std::string& color, const Names& depths) {
  const std::string layer = layer_of_color(color);
  Names own, free;
  for (const std::string& depth : depths) {
    const std::string of = layer_of_depth(depth);
    if (of == layer) own.push_back(depth);
    if (!layer_has_color(image, of)) free.push_back(depth);
  }
  return own.empty() ? free : own;
}

/// Of several colours, those whose own layer has a depth.
Names colors_with_depth(const Names& colors, const Names& depths) {
  Names result;
  for (const std::string& color : colors) {
    const auto own = [&](const std::string& depth) {
      return layer_of_depth(depth) == layer_of_color(color);
    };
    if (std::ranges::any_of(depths, own)) result.push_back(color);
  }
  return result;
}

std::string find_color(const Image& image, const std::string& asked, const Names& depths) {
  if (asked != DepthPictureConfig::kFind) {
    if (has_color(image, asked)) return asked;
    throw ValueError(
        fmt::format("no channels {0}R, {0}G, {0}B; there are: {1}", asked, names_of(image)));
  }
  Names colors = color_candidates(image);
  if (colors.empty())
    throw ValueError(fmt::format("no channels R, G, B; there are: {}", names_of(image)));
  if (colors.size() > 1) {
    const Names with_depth = colors_with_depth(colors, depths);
    if (with_depth.size() != 1) {
      throw ValueError(fmt::format("several layers have a colour: {}; one must be asked for",
                                   fmt::join(colors, ", ")));
    }
    colors = with_depth;
  }
  return colors.front();
}

std::string find_depth(const Image& image, const std::string& asked, const std::string& color,
                       const Names& depths) {
  if (asked != DepthPictureConfig::kFind) return asked;
  if (depths.empty())
    throw ValueError(fmt::format("no depth channel (Z); there are: {}", names_of(image)));
  const Names found = depths_for(image, color, depths);
  if (found.empty()) {
    throw ValueError(fmt::format("no depth in the layer of {}R; that of other layers: {}", color,
                                 fmt::join(depths, ", ")));
  }
  const auto same_layer = [&](const std::string& depth) {
    return layer_of_depth(depth) == layer_of_depth(found.front());
  };
  if (!std::ranges::all_of(found, same_layer)) {
    throw ValueError(fmt::format("several layers have a depth: {}; one must be asked for",
                                 fmt::join(found, ", ")));
  }
  return found.front();
}

}  // namespace

bool has_color(const Image& image, const std::string& prefix) {
  return image.has(prefix + "R") && image.has(prefix + "G") && image.has(prefix + "B");
}

PictureChannels find_channels(const Image& image, const DepthPictureConfig& config) {
  const bool depth_asked = config.depth != DepthPictureConfig::kFind;
  if (depth_asked && !image.has(config.depth))
    throw ValueError(fmt::format("no channel {}; there are: {}", config.depth, names_of(image)));
  const Names depths = depth_asked ? Names{config.depth} : depth_candidates(image);
  const std::string color = find_color(image, config.color, depths);
  return {color, find_depth(image, config.depth, color, depths)};
}

}  // namespace relumbre
