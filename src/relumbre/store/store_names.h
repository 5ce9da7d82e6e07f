/// Names and words that the store's writer and reader share.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "relumbre/geometry/tessellation.h"

namespace relumbre {

inline constexpr std::string_view kStoreFormat = "relumbre-store";

inline constexpr std::array<std::pair<PatchMethod, std::string_view>, 2> kPatchMethodNames{{
    {PatchMethod::kHierarchy, "hierarchy"},
    {PatchMethod::kCluster, "cluster"},
}};

/// "textures/7"
inline std::string texture_path(std::size_t index) { return "textures/" + std::to_string(index); }

}  // namespace relumbre
