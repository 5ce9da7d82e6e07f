/// Scene files on the command line: their options, and the import with its report.
#pragma once

#include <string>

#include "cli/command.h"
#include "relumbre/scene/import.h"

namespace relumbre::cli {

struct SceneOptions {
  std::string file;
  std::string sides = "auto";
  ImportConfig import;
};

/// Binds the scene argument and how to read it.
void add_scene_options(CLI::App& command, SceneOptions& options);

/// Imports and reports what it holds and what was dropped.
Scene import_and_report(const SceneOptions& options, Session& session);

/// Objects, materials, lights and cameras of a scene.
void report_scene(const Scene& scene, Session& session);

}  // namespace relumbre::cli
