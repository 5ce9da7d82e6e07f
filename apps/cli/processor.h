/// Who does the heavy work of a subcommand: the CPU, or a GPU.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/command.h"
#include "relumbre/dof/depth_of_field.h"
#include "relumbre/octree/tree_cast.h"
#include "relumbre/radiosity/form_factors.h"
#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre::cli {

/// The CPU; a GPU does each of these in its own way.
class Processor {
 public:
  virtual ~Processor() = default;
  /// For reports: empty, or the device's name.
  [[nodiscard]] virtual std::string name() const { return {}; }
  [[nodiscard]] virtual RayScene ray_scene(const TriangleMesh& mesh) const {
    return RayScene(mesh);
  }
  /// Empty: bake()'s own.
  [[nodiscard]] virtual FormFactorTracer form_factor_tracer() const { return {}; }
  [[nodiscard]] virtual std::unique_ptr<EditableOperator> relight_operator(
      const OperatorInput& input, CountFormat format) const {
    return make_compressed_operator(input, format);
  }
  [[nodiscard]] virtual std::vector<Rgba> depth_of_field(const DepthPicture& picture,
                                                         const DofConfig& config,
                                                         Progress& progress) const {
    return relumbre::depth_of_field(picture, config, progress);
  }
  /// Empty: render_voxels()'s own. The tree must outlive it.
  [[nodiscard]] virtual TreeCaster tree_caster(const VoxelTree&) const { return {}; }
};

/// --device, with the default "cpu".
void add_device_option(CLI::App& command, std::string& device);

/// Of "cpu", "cuda" or "cuda:N". Throws ValueError for another name, a device that is not there, or
/// a program that was built without CUDA. Says in the report whose work it is, if not the CPU's.
std::unique_ptr<Processor> make_processor(const std::string& device, Session& session);

/// What `info --devices` prints.
void report_devices(Session& session);

}  // namespace relumbre::cli
