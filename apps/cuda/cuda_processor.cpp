#include "cli/cuda_processor.h"

#include "relumbre/cuda/device.h"
#include "relumbre/dof/depth_of_field_cuda.h"
#include "relumbre/octree/tree_cast_cuda.h"
#include "relumbre/radiosity/form_factors_cuda.h"
#include "relumbre/radiosity/relight_operator_cuda.h"
#include "relumbre/visibility/ray_scene_cuda.h"

namespace relumbre::cli {

namespace {

class CudaProcessor final : public Processor {
 public:
  explicit CudaProcessor(int device) : device_(device) {}

  [[nodiscard]] std::string name() const override {
    const cuda::UseDevice use(device_);
    return fmt::format("cuda:{}, {}", device_, cuda::current_device().name);
  }
  [[nodiscard]] RayScene ray_scene(const TriangleMesh& mesh) const override {
    return cuda::make_ray_scene(mesh, device_);
  }
  [[nodiscard]] FormFactorTracer form_factor_tracer() const override {
    return cuda::form_factor_tracer(device_);
  }
  [[nodiscard]] std::unique_ptr<EditableOperator> relight_operator(
      const OperatorInput& input, CountFormat format) const override {
    return cuda::make_compressed_operator(input, format, device_);
  }
  [[nodiscard]] std::vector<Rgba> depth_of_field(const DepthPicture& picture,
                                                 const DofConfig& config,
                                                 Progress&) const override {
    const cuda::UseDevice use(device_);
    return cuda::depth_of_field(picture, config);
  }
  [[nodiscard]] TreeCaster tree_caster(const VoxelTree& tree) const override {
    const cuda::UseDevice use(device_);
    const auto there = std::make_shared<const cuda::DeviceTree>(tree);
    return [there](std::span<const CastRay> rays, std::span<TreeHit> hits) {
      there->cast(rays, hits);
    };
  }

 private:
  int device_;
};

}  // namespace

std::unique_ptr<Processor> make_cuda_processor(const std::string& device) {
  return std::make_unique<CudaProcessor>(cuda::parse_device(device));
}

void report_cuda_devices(Session& session) {
  const std::vector<cuda::DeviceInfo> devices = cuda::devices();
  nlohmann::json list = nlohmann::json::array();
  for (const cuda::DeviceInfo& d : devices) {
    list.push_back({{"device", fmt::format("cuda:{}", d.index)},
                    {"name", d.name},
                    {"compute_capability", fmt::format("{}.{}", d.major, d.minor)},
                    {"multiprocessors", d.multiprocessors},
                    {"memory_bytes", d.memory_bytes},
                    {"free_bytes", d.free_bytes}});
    session.report.note(
        fmt::format("  cuda:{}  {}, compute capability {}.{}, {} multiprocessors, "
                    "{} of {} free",
                    d.index, d.name, d.major, d.minor, d.multiprocessors, bytes_text(d.free_bytes),
                    bytes_text(d.memory_bytes)));
  }
  session.report.json()["cuda_devices"] = list;
  const cuda::Versions v = cuda::versions();
  const auto text = [](int version) {
    return version == 0 ? std::string("none")
                        : fmt::format("{}.{}", version / 1000, version % 1000 / 10);
  };
  session.report.figure("cuda_driver", "CUDA of the driver", v.driver, text(v.driver));
  session.report.figure("cuda_runtime", "CUDA of this program", v.runtime, text(v.runtime));
  if (devices.empty()) session.report.note("  no CUDA device was found");
}

}  // namespace relumbre::cli
