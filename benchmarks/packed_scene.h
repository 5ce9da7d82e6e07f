/// Scenes of the data folder, packed with xz.
#pragma once

#include <optional>
#include <string>

#include "relumbre/scene/scene.h"

namespace relumbre::bench {

/// RELUMBRE_DATA, or ../shared/data.
std::string data_folder();

/// `file` of the data folder, with `.xz` left out of its name; `companion` (an OBJ's materials,
/// say) is put beside it. None where it is missing. Needs the program xz.
std::optional<Scene> read_packed_scene(const std::string& file, const std::string& companion = {});

}  // namespace relumbre::bench
