#include "relumbre/scene/gltf_reduce.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "relumbre/base/error.h"
#include "relumbre/scene/gltf_reduction.h"
#include "relumbre/scene/scene.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

using nlohmann::json;

constexpr std::size_t kMaxDepth = 128;
constexpr std::size_t kMaxTexcoords = 4;

constexpr std::array<std::string_view, 15> kKnownExtensions = {
    "KHR_lights_punctual",     "KHR_texture_transform",     "KHR_materials_anisotropy",
    "KHR_materials_clearcoat", "KHR_materials_dispersion",  "KHR_materials_emissive_strength",
    "KHR_materials_ior",       "KHR_materials_iridescence", "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",     "KHR_materials_specular",    "KHR_materials_transmission",
    "KHR_materials_unlit",     "KHR_materials_variants",    "KHR_materials_volume",
};

/// Builds the reduced document section by section; each section checks against those before it.
class Reducer {
 public:
  Reducer(const GltfDocument& document, fs::path folder, const std::string& file_name,
          float default_reflectance)
      : r_{document, std::move(folder), file_name, {}, {}, {}},
        default_reflectance_(default_reflectance) {}

  ReducedGltf run() {
    check_extensions();
    r_.out["asset"] = {{"version", "2.0"}};
    reduce_gltf_buffers(r_);
    reduce_gltf_materials(r_);
    add_default_materials();
    section("meshes", "mesh", &Reducer::mesh);
    section("nodes", "node", &Reducer::node);
    check_forest();
    section("scenes", "scene", &Reducer::scene);
    if (r_.count("scenes") == 0) throw FileError(r_.file_name, "holds no scene");
    const JsonFields root(r_.document.json, r_.file_name, "");
    r_.out["scene"] = root.index("scene", r_.count("scenes"), 0);
    return {std::move(r_.out), std::move(r_.materials), points_and_lines_, std::move(r_.warnings)};
  }

 private:
  void section(const char* key, const std::string& singular,
               json (Reducer::*rule)(const JsonFields&, std::size_t)) {
    r_.section(key, singular, [this, rule](const JsonFields& fields, std::size_t i) {
      return (this->*rule)(fields, i);
    });
  }

  void check_extensions() {
    const auto required = r_.document.json.find("extensionsRequired");
    if (required == r_.document.json.end()) return;
    for (const json& name : *required) {
      const std::string text = name.is_string() ? name.get<std::string>() : "?";
      if (std::ranges::find(kKnownExtensions, text) == kKnownExtensions.end()) {
        throw FileError(r_.file_name, "needs the glTF extension " + text.substr(0, 80) +
                                          ", which is not supported");
      }
    }
  }

  /// For primitives without a material: grey, and white below vertex colours.
  void add_default_materials() {
    default_material_ = add_grey_material(default_reflectance_);
    white_material_ = add_grey_material(kMaxReflectance);
  }
  std::size_t add_grey_material(float grey) {
    const std::size_t index = r_.count("materials");
    r_.materials.push_back({"default", {}});
    r_.out["materials"].push_back(
        {{"name", std::to_string(index)},
         {"pbrMetallicRoughness", {{"baseColorFactor", {grey, grey, grey, 1}}}}});
    return index;
  }

  json mesh(const JsonFields& fields, std::size_t i) {
    json out = {{"name", gltf_name(fields, "mesh " + std::to_string(i))},
                {"primitives", json::array()}};
    const json& primitives = fields.at("primitives");
    if (!primitives.is_array()) fields.fail("primitives", "must be an array");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const JsonFields primitive_fields(
          primitives[p], r_.file_name,
          "mesh " + std::to_string(i) + " primitive " + std::to_string(p));
      if (std::optional<json> reduced = primitive(primitive_fields)) {
        out["primitives"].push_back(std::move(*reduced));
      }
    }
    return out;
  }

  std::optional<json> primitive(const JsonFields& fields) {
    constexpr std::size_t triangles = 4, modes = 7;
    const std::size_t mode = fields.index("mode", modes, triangles);
    const JsonFields attributes = fields.object("attributes");
    if (!attributes.has("POSITION")) return std::nullopt;
    const std::size_t positions = float_accessor(attributes, "POSITION", "VEC3");
    if (mode < triangles) {
      points_and_lines_ += vertices_of(positions);
      return std::nullopt;
    }
    json out = {{"mode", mode}, {"attributes", {{"POSITION", positions}}}};
    copy_attributes(attributes, positions, out["attributes"]);
    if (fields.has("indices")) out["indices"] = index_accessor(fields);
    const bool colored = out["attributes"].contains("COLOR_0");
    out["material"] =
        fields.index("material", default_material_, colored ? white_material_ : default_material_);
    if (fields.has("targets")) r_.warn("morph targets are left out");
    return out;
  }

  void copy_attributes(const JsonFields& attributes, std::size_t positions, json& out) {
    const auto copy = [&](const std::string& key, const char* shape) {
      const std::size_t accessor = float_accessor(attributes, key, shape);
      if (vertices_of(accessor) != vertices_of(positions)) {
        attributes.fail(key, "has another count than POSITION");
      }
      out[key] = accessor;
    };
    if (attributes.has("NORMAL")) copy("NORMAL", "VEC3");
    for (std::size_t i = 0; i < kMaxTexcoords; ++i) {
      const std::string key = "TEXCOORD_" + std::to_string(i);
      if (!attributes.has(key)) break;
      copy(key, "VEC2");
    }
    if (attributes.has("COLOR_0")) copy_colors(attributes, positions, out);
  }

  /// RGB or RGBA of float, or RGBA of normalised bytes or shorts.
  void copy_colors(const JsonFields& attributes, std::size_t positions, json& out) {
    const std::size_t index = attributes.index("COLOR_0", r_.count("accessors"));
    const json& accessor = r_.out.at("accessors")[index];
    const int component = accessor["componentType"].get<int>();
    const bool is_float = component == 5126, is_unsigned = component == 5121 || component == 5123;
    const bool has_alpha = accessor["type"] == "VEC4";
    if (!(has_alpha && is_unsigned) && !(is_float && (has_alpha || accessor["type"] == "VEC3")))
      return r_.warn("vertex colours that are neither float nor RGBA are left out");
    if (vertices_of(index) != vertices_of(positions))
      attributes.fail("COLOR_0", "has another count than POSITION");
    out["COLOR_0"] = index;
  }

  [[nodiscard]] std::size_t vertices_of(std::size_t accessor) const {
    return r_.out.at("accessors")[accessor]["count"].get<std::size_t>();
  }

  std::size_t float_accessor(const JsonFields& fields, const std::string& key,
                             const char* shape) const {
    const std::size_t index = fields.index(key, r_.count("accessors"));
    const json& accessor = r_.out.at("accessors")[index];
    if (accessor["componentType"] != 5126 || accessor["type"] != shape) {
      fields.fail(key, "is not " + std::string(shape) + " of float");
    }
    return index;
  }

  std::size_t index_accessor(const JsonFields& fields) const {
    const std::size_t index = fields.index("indices", r_.count("accessors"));
    const json& accessor = r_.out.at("accessors")[index];
    const auto type = accessor["componentType"].get<int>();
    if ((type != 5121 && type != 5123 && type != 5125) || accessor["type"] != "SCALAR") {
      fields.fail("indices", "is not SCALAR of an unsigned type");
    }
    return index;
  }

  json node(const JsonFields& fields, std::size_t i) {
    json out = json::object();
    std::string fallback = "node " + std::to_string(i);
    if (fields.has("mesh")) {
      const std::size_t mesh = fields.index("mesh", r_.count("meshes"));
      out["mesh"] = mesh;
      fallback = r_.out["meshes"][mesh]["name"].get<std::string>();
    }
    out["name"] = gltf_name(fields, fallback);
    if (fields.has("skin")) r_.warn("skins are left out: meshes keep their bind pose");
    copy_numbers(fields, "matrix", 16, out);
    if (!out.contains("matrix")) {
      copy_numbers(fields, "translation", 3, out);
      copy_numbers(fields, "rotation", 4, out);
      copy_numbers(fields, "scale", 3, out);
    }
    if (fields.has("children")) out["children"] = node_list(fields, "children", size_of("nodes"));
    return out;
  }

  static void copy_numbers(const JsonFields& fields, const char* key, std::size_t n, json& out) {
    if (fields.has(key)) out[key] = fields.numbers(key, n);
  }

  [[nodiscard]] std::size_t size_of(const char* key) const {
    return r_.document.json.contains(key) ? r_.document.json[key].size() : 0;
  }

  static json node_list(const JsonFields& fields, const char* key, std::size_t nodes) {
    const json& list = fields.at(key);
    const bool valid = list.is_array() && std::ranges::all_of(list, [&](const json& v) {
                         return v.is_number_unsigned() && v.get<std::uint64_t>() < nodes;
                       });
    if (!valid) fields.fail(key, "must be an array of nodes that exist");
    return list;
  }

  /// Every node has at most one parent, and no chain of parents is longer than kMaxDepth (so none
  /// is endless either).
  void check_forest() const {
    const json& nodes = r_.out.at("nodes");
    std::vector<std::size_t> parent(nodes.size(), nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!nodes[i].contains("children")) continue;
      for (const json& child : nodes[i]["children"]) {
        std::size_t& its_parent = parent[child.get<std::size_t>()];
        if (its_parent != nodes.size()) {
          throw FileError(r_.file_name, "node " + child.dump() + " has two parents");
        }
        its_parent = i;
      }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::size_t depth = 0;
      for (std::size_t up = parent[i]; up != nodes.size(); up = parent[up]) {
        if (++depth > kMaxDepth) throw FileError(r_.file_name, "nodes are nested too deeply");
      }
    }
  }

  json scene(const JsonFields& fields, std::size_t) {
    json out = {{"nodes", json::array()}};
    if (!fields.has("nodes")) return out;
    out["nodes"] = node_list(fields, "nodes", r_.count("nodes"));
    std::vector<std::uint8_t> seen(r_.count("nodes"), 0);
    for (const json& node : out["nodes"]) {
      if (seen[node.get<std::size_t>()]++ > 0) fields.fail("nodes", "names a node twice");
    }
    return out;
  }

  GltfReduction r_;
  float default_reflectance_;
  std::size_t default_material_ = 0, white_material_ = 0;
  std::size_t points_and_lines_ = 0;
};

}  // namespace

void GltfReduction::warn(const std::string& warning) {
  if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(warning);
}

void GltfReduction::section(const char* key, const std::string& singular,
                            const std::function<json(const JsonFields&, std::size_t)>& rule) {
  out[key] = json::array();
  if (!document.json.contains(key)) return;
  const json& array = document.json[key];
  if (!array.is_array()) throw FileError(file_name, std::string(key) + " is not an array");
  for (std::size_t i = 0; i < array.size(); ++i) {
    const JsonFields fields(array[i], file_name, singular + " " + std::to_string(i));
    json reduced = rule(fields, i);
    out[key].push_back(std::move(reduced));
  }
}

std::string gltf_name(const JsonFields& fields, const std::string& fallback) {
  constexpr std::size_t longest = 200;
  const std::string name = fields.text("name", "").substr(0, longest);
  return name.empty() ? fallback : name;
}

ReducedGltf reduce_gltf(const GltfDocument& document, const fs::path& folder,
                        const std::string& file_name, float default_reflectance) {
  return Reducer(document, folder, file_name, default_reflectance).run();
}

}  // namespace relumbre
