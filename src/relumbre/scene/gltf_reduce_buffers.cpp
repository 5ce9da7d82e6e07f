#include <cstdint>
#include <optional>
#include <system_error>

#include "relumbre/scene/gltf_reduction.h"
#include "relumbre/scene/gltf_uri.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr std::size_t kMaxBytes = std::size_t{1} << 40;
constexpr std::size_t kMaxItems = std::size_t{1} << 31;

std::size_t file_size(const GltfReduction& r, const JsonFields& fields, const std::string& uri) {
  const std::optional<std::string> name = decode_relative_uri(uri);
  if (!name) fields.fail("uri", "is neither a file beside the scene nor base64 data");
  std::error_code error;
  const fs::path file = r.folder / *name;
  if (!fs::is_regular_file(file, error)) fields.fail("file '" + *name + "' is missing");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) fields.fail("file '" + *name + "': " + error.message());
  return static_cast<std::size_t>(size);
}

json buffer(const GltfReduction& r, const JsonFields& fields, std::size_t i) {
  const std::size_t length = fields.index("byteLength", kMaxBytes);
  json out = {{"byteLength", length}};
  std::size_t available = r.document.bin_size;
  if (fields.has("uri")) {
    const std::string uri = fields.text("uri");
    const std::optional<std::size_t> embedded = data_uri_size(uri);
    available = embedded ? *embedded : file_size(r, fields, uri);
    out["uri"] = embedded ? uri : decode_relative_uri(uri).value();
  } else if (i != 0 || !r.document.binary_container) {
    fields.fail("uri", "is missing");
  }
  if (length > available) fields.fail("byteLength", "is more than there is: truncated data");
  return out;
}

json buffer_view(const GltfReduction& r, const JsonFields& fields) {
  const std::size_t buffer = fields.index("buffer", r.count("buffers"));
  const std::size_t size = r.out.at("buffers")[buffer]["byteLength"].get<std::size_t>();
  const std::size_t offset = fields.index("byteOffset", size + 1, 0);
  const std::size_t length = fields.index("byteLength", size - offset + 1);
  json out = {{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", length}};
  if (fields.has("byteStride")) {
    const std::size_t stride = fields.index("byteStride", 253);
    if (stride < 4) fields.fail("byteStride", "must be from 4 to 252");
    out["byteStride"] = stride;
  }
  return out;
}

std::size_t component_size(const JsonFields& fields, std::size_t type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      fields.fail("componentType", "is not one that glTF knows");
  }
}

std::size_t components(const JsonFields& fields, const std::string& shape) {
  if (shape == "SCALAR") return 1;
  if (shape == "VEC2") return 2;
  if (shape == "VEC3") return 3;
  if (shape == "VEC4" || shape == "MAT2") return 4;
  if (shape == "MAT3") return 9;
  if (shape == "MAT4") return 16;
  fields.fail("type", "is not one that glTF knows");
}

json accessor(const GltfReduction& r, const JsonFields& fields) {
  if (fields.has("sparse")) fields.fail("sparse accessors are not supported");
  const std::size_t view_index = fields.index("bufferView", r.count("bufferViews"));
  const json& view = r.out.at("bufferViews")[view_index];
  const std::size_t type = fields.index("componentType", 5127);
  const std::string shape = fields.text("type");
  const std::size_t element = component_size(fields, type) * components(fields, shape);
  const std::size_t items = fields.index("count", kMaxItems);
  const std::size_t size = view["byteLength"].get<std::size_t>();
  const std::size_t offset = fields.index("byteOffset", size + 1, 0);
  const std::size_t stride = view.value("byteStride", element);
  if (items == 0) fields.fail("count", "must be at least 1");
  if (stride < element || offset + (items - 1) * stride + element > size) {
    fields.fail("reaches beyond its buffer view");
  }
  return {{"bufferView", view_index},
          {"byteOffset", offset},
          {"componentType", type},
          {"count", items},
          {"type", shape}};
}

}  // namespace

void reduce_gltf_buffers(GltfReduction& r) {
  r.section("buffers", "buffer",
            [&](const JsonFields& fields, std::size_t i) { return buffer(r, fields, i); });
  r.section("bufferViews", "buffer view",
            [&](const JsonFields& fields, std::size_t) { return buffer_view(r, fields); });
  r.section("accessors", "accessor",
            [&](const JsonFields& fields, std::size_t) { return accessor(r, fields); });
}

}  // namespace relumbre
