#include "cli/exposure.h"
#include "cli/opened_store.h"
#include "relumbre/base/error.h"
#include "relumbre/render/colored_mesh.h"
#include "relumbre/scene/gltf_writer.h"
#include "relumbre/scene/ply_writer.h"

namespace relumbre::cli {

namespace {

struct Options {
  StoreOptions store;
  std::string output;
  std::string exposure = "auto";
};

std::string extension(const std::string& file) {
  return std::filesystem::path(file).extension().string();
}

void check_output(const std::string& file) {
  const std::string kind = extension(file);
  if (kind != ".npy" && kind != ".ply" && kind != ".glb") {
    throw FileError(file, "cannot be written: relight writes .npy, .ply and .glb");
  }
}

/// What colours are multiplied by: 2^stops, or what a picture of all elements would be exposed by.
float color_scale(const std::string& exposure, std::span<const Rgb> radiosity) {
  Image elements = rgb_image(radiosity.size(), 1);
  for (std::size_t i = 0; i < radiosity.size(); ++i) elements.set_rgb(i, radiosity[i]);
  return exposure_scale(elements, parse_exposure(exposure));
}

void write_mesh(const Options& options, const Tessellation& tessellation,
                std::span<const Rgb> radiosity) {
  const ColoredMesh mesh = colored_mesh(tessellation, conforming_mesh(tessellation), radiosity);
  const float scale = color_scale(options.exposure, radiosity);
  std::vector<Rgb> colors = mesh.colors;
  for (Rgb& color : colors) color *= scale;
  if (extension(options.output) == ".ply") {
    write_ply(options.output, {mesh.positions, mesh.triangles, colors, mesh.colors});
  } else {
    write_colored_mesh(options.output, mesh.positions, mesh.triangles, colors);
  }
}

/// B for each source of --emission.
void relight_emission(const Options& options, const OpenedStore& store, Session& session) {
  FloatArray emission = store.read_emission();
  const std::size_t sources = emission.shape.size() == 3 ? emission.shape[0] : 1;
  const auto relight_operator = store.make_operator(session);
  const Stopwatch watch;
  relight_operator->apply(emission.data, emission.data, sources);
  session.report.figure("sources", "source vectors", sources);
  session.report.figure("relight_s", "relit in", watch.seconds(), seconds_text(watch.seconds()));
  if (extension(options.output) == ".npy") {
    write_npy(options.output, emission.shape, emission.data);
  } else if (sources == 1) {
    std::vector<Rgb> radiosity(store.baked.tessellation.elements());
    std::copy(emission.data.begin(), emission.data.end(), flat(radiosity).begin());
    write_mesh(options, store.baked.tessellation, radiosity);
  } else {
    throw FileError(options.output, "one mesh cannot hold several source vectors; write .npy");
  }
}

void relight_lights(const Options& options, const OpenedStore& store, Session& session) {
  const RelitResult lit = store.relight(session);
  if (extension(options.output) == ".npy") {
    const std::size_t shape[] = {lit.radiosity.size(), 3};
    write_npy(options.output, shape, flat(lit.radiosity));
  } else {
    write_mesh(options, store.baked.tessellation, lit.radiosity);
  }
}

void run(const Options& options, Session& session) {
  check_output(options.output);
  const OpenedStore store(options.store, session);
  store.has_emission() ? relight_emission(options, store, session)
                       : relight_lights(options, store, session);
  session.report.figure("output", "wrote", options.output);
}

}  // namespace

void add_relight_command(CLI::App& app) {
  add_command<Options>(
      app, "relight", "Radiosity of every element under given lights",
      "relumbre relight room.h5 --lights evening.json -o evening.glb",
      [](CLI::App& command, Options& o) {
        add_store_options(command, o.store);
        add_device_option(command, o.store.device);
        command
            .add_option("-o,--output", o.output, "B.npy, or a mesh with vertex colours: .ply, .glb")
            ->required();
        command.add_option("--exposure", o.exposure, "Of a mesh's colours: auto, or stops")
            ->capture_default_str();
      },
      run);
}

}  // namespace relumbre::cli
