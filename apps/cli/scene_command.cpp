#include "cli/command.h"
#include "relumbre/base/error.h"
#include "relumbre/scene/builtin_scenes.h"
#include "relumbre/scene/gltf_writer.h"

namespace relumbre::cli {

namespace {

struct Options {
  std::string name, output;
  bool list = false;
};

void list_scenes(Session& session) {
  for (const BuiltinScene& scene : builtin_scenes()) {
    session.report.figure(scene.name, scene.name, scene.description);
  }
}

void run(const Options& options, Session& session) {
  if (options.list) return list_scenes(session);
  if (options.name.empty() || options.output.empty()) {
    throw CLI::RequiredError("scene: NAME and --output (or --list)");
  }
  const Scene scene = make_builtin_scene(options.name);
  write_gltf(options.output, scene);
  session.report.note(options.output);
  session.report.figure("triangles", "triangles", scene.mesh.triangles.size(),
                        grouped(scene.mesh.triangles.size()));
  session.report.figure("objects", "objects", scene.objects.size());
  session.report.figure("lights", "lights", scene.lights.size());
  session.report.figure("cameras", "cameras", scene.cameras.size());
}

}  // namespace

void add_scene_command(CLI::App& app) {
  add_command<Options>(
      app, "scene", "Write a built-in scene as glTF", "relumbre scene room -o room.glb",
      [](CLI::App& command, Options& o) {
        command.add_option("name", o.name, "Which scene; --list names them");
        command.add_option("-o,--output", o.output, "File to write: .glb or .gltf");
        command.add_flag("--list", o.list, "List the built-in scenes");
      },
      run);
}

}  // namespace relumbre::cli
