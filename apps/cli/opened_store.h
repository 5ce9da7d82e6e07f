/// A store made ready to relight: what relight, solve, render and info share.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/processor.h"
#include "relumbre/base/npy.h"
#include "relumbre/radiosity/relight_operator.h"
#include "relumbre/render/relight.h"
#include "relumbre/store/store.h"
#include "relumbre/visibility/ray_scene.h"

namespace relumbre::cli {

struct StoreOptions {
  std::string store;
  std::string lights;    ///< lights.json
  std::string emission;  ///< E.npy, instead of lights
  bool no_scene_lights = false;
  bool no_cache = false;
  DirectLightConfig direct;
  std::string format = "counts8";
  std::vector<std::string> reflectance;  ///< "material=r,g,b"
  std::string device = "cpu";            ///< who traces rays and relights
};

/// Binds the store argument and the options above. With a `name` of "--store", the store is an
/// option that may be left out.
void add_store_options(CLI::App& command, StoreOptions& options, const std::string& name = "store");

/// A baked scene, its lights and its direct light, with the reflectance edits applied.
class OpenedStore {
 public:
  OpenedStore(const StoreOptions& options, Session& session);

  std::unique_ptr<Processor> processor;
  BakedScene baked;
  RayScene rays;
  std::vector<Light> lights;  ///< empty where emission is given

  /// Direct light of `lights`; responses are cached beside the store. Throws ValueError naming the
  /// store if there are no lights.
  [[nodiscard]] std::vector<LightResponse> responses(Session& session) const;
  /// The relight operator in the asked format.
  [[nodiscard]] std::unique_ptr<RelightOperator> make_operator(Session& session) const;
  /// Emission, direct light and the operator's answer for `lights`.
  [[nodiscard]] RelitResult relight(Session& session) const;
  /// E of lights: directly reflected light. n.
  [[nodiscard]] std::vector<Rgb> reflected(Session& session) const;
  /// E of --emission: sources × n × 3, checked against n.
  [[nodiscard]] FloatArray read_emission() const;
  [[nodiscard]] bool has_emission() const { return !options_.emission.empty(); }

 private:
  StoreOptions options_;
};

/// The same memory as floats, RGB interleaved.
std::span<float> flat(std::vector<Rgb>& values);
std::span<const float> flat(const std::vector<Rgb>& values);

}  // namespace relumbre::cli
