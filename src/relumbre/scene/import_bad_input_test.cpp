#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/scene/gltf_document.h"
#include "relumbre/scene/gltf_uri.h"
#include "relumbre/scene/import.h"
#include "relumbre/scene/test_gltf.h"

namespace relumbre {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ImportBadInput : public ::testing::Test {
 protected:
  /// The file is refused with one line that starts with its name and says why.
  void expect_refused(const std::string& name, const std::string& bytes,
                      const std::string& reason) {
    write_file(folder_ / name, bytes);
    try {
      import_scene(folder_ / name);
      ADD_FAILURE() << name << " was taken";
    } catch (const FileError& error) {
      EXPECT_THAT(error.what(), AllOf(StartsWith((folder_ / name).string() + ": "),
                                      HasSubstr(reason), Not(HasSubstr("\n"))));
    }
  }

  /// The square document after a change.
  void expect_refused_after(const std::function<void(json&)>& change, const std::string& reason) {
    json document = gltf::square();
    change(document);
    expect_refused("scene.gltf", document.dump(), reason);
  }

  TemporaryFolder folder_;
};

constexpr const char* kExtensions[] = {".obj", ".ply", ".stl", ".gltf", ".glb"};

TEST_F(ImportBadInput, MissingFolderAndUnknownKind) {
  for (const char* extension : kExtensions) {
    const auto file = folder_ / (std::string("missing") + extension);
    EXPECT_THROW(import_scene(file), FileError);
  }
  EXPECT_THROW(import_scene(folder_.path()), FileError);
  expect_refused("scene.fbx", "anything", "is not one of");
  expect_refused("scene", "anything", "is not one of");
}

TEST_F(ImportBadInput, EmptyFiles) {
  for (const char* extension : kExtensions) {
    expect_refused(std::string("empty") + extension, "", "is empty");
  }
}

TEST_F(ImportBadInput, FilesOfAnotherKind) {
  const std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01", 20);
  for (const char* extension : kExtensions) {
    expect_refused(std::string("picture") + extension, png, "");
  }
  for (const char* extension : kExtensions) {
    expect_refused(std::string("prose") + extension, "Once upon a time\nthere was a lamp.\n", "");
  }
}

TEST_F(ImportBadInput, NoTriangles) {
  expect_refused("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "");
  expect_refused("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1\nl 1 2\n", "no triangles");
  expect_refused("degenerate.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "no usable triangles");
  expect_refused("nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no usable triangles");
  expect_refused("a.stl", std::string(84, '\0'), "");
}

TEST_F(ImportBadInput, FacesWithVerticesThatAreNotThere) {
  expect_refused("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "");
  expect_refused("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
                 "");
}

TEST_F(ImportBadInput, TruncatedPly) {
  const std::string header =
      "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  expect_refused("text.ply", "ply\nformat ascii 1.0\n" + header + "0 0 0\n1 0 0\n0 1 0\n",
                 "truncated");
  const std::string binary = "ply\nformat binary_little_endian 1.0\n" + header;
  expect_refused("binary.ply", binary + gltf::bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\x03",
                 "truncated");
  expect_refused("header.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "truncated");
  expect_refused("huge.ply",
                 "ply\nformat ascii 1.0\nelement vertex 99999999999999\nproperty float x\n"
                 "end_header\n1\n",
                 "count");
}

TEST_F(ImportBadInput, TruncatedStl) {
  expect_refused("binary.stl",
                 std::string(80, ' ') + gltf::bytes_of<std::uint32_t>({2}) + std::string(50, '\0'),
                 "truncated");
  expect_refused("text.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "endsolid");
}

TEST_F(ImportBadInput, TruncatedGltfAtEveryFewBytes) {
  GltfDocument document;
  document.json = gltf::square();
  document.binary_container = true;
  document.bytes = std::string(128, '\0');
  document.bin_size = document.bytes.size();
  const std::string text = document.json.dump(), binary = serialize(document, "a.glb");
  for (std::size_t size = 1; size < text.size(); size += 131) {
    expect_refused("a.gltf", text.substr(0, size), "JSON");
  }
  const std::size_t bin_header = binary.size() - document.bin_size - 8;
  for (std::size_t size = 1; size < bin_header; size += 61) {
    expect_refused("a.glb", binary.substr(0, size), "");
  }
}

TEST_F(ImportBadInput, GltfThatIsNotOfVersionTwo) {
  expect_refused_after([](json& d) { d["asset"]["version"] = "1.0"; }, "version 2");
  expect_refused_after([](json& d) { d.erase("asset"); }, "asset");
  expect_refused_after([](json& d) { d = json::array({1}); }, "object");
  expect_refused_after([](json& d) { d["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
                       "KHR_draco_mesh_compression");
}

TEST_F(ImportBadInput, GltfIndicesThatPointNowhere) {
  expect_refused_after([](json& d) { d["nodes"][0]["mesh"] = 7; }, "node 0");
  expect_refused_after([](json& d) { d["nodes"][0]["mesh"] = -1; }, "node 0");
  expect_refused_after([](json& d) { d["nodes"][0]["mesh"] = "x"; }, "node 0");
  expect_refused_after([](json& d) { d["scenes"][0]["nodes"] = {3}; }, "scene 0");
  expect_refused_after([](json& d) { d["scene"] = 3; }, "scene");
  expect_refused_after([](json& d) { d["nodes"][0]["camera"] = 0; }, "cameras");
  expect_refused_after([](json& d) { d["meshes"][0]["primitives"][0]["indices"] = 9; }, "mesh 0");
  expect_refused_after([](json& d) { d["meshes"][0]["primitives"][0]["material"] = 1; }, "mesh 0");
  expect_refused_after([](json& d) { d["meshes"][0]["primitives"][0]["indices"] = 1; }, "SCALAR");
  expect_refused_after([](json& d) { d["accessors"][0]["bufferView"] = 9; }, "accessor 0");
  expect_refused_after([](json& d) { d["bufferViews"][0]["buffer"] = 9; }, "buffer view 0");
}

TEST_F(ImportBadInput, GltfDataBeyondItsBuffer) {
  expect_refused_after([](json& d) { d["accessors"][1]["count"] = 5; }, "accessor 1");
  expect_refused_after([](json& d) { d["accessors"][1]["byteOffset"] = 4; }, "accessor 1");
  expect_refused_after([](json& d) { d["accessors"][1]["sparse"] = {{"count", 1}}; }, "sparse");
  expect_refused_after([](json& d) { d["bufferViews"][1]["byteLength"] = 200; }, "buffer view 1");
  expect_refused_after([](json& d) { d["buffers"][0]["byteLength"] = 129; }, "truncated");
  expect_refused_after([](json& d) { d["buffers"][0]["uri"] = "gone.bin"; }, "gone.bin");
  expect_refused_after([](json& d) { d["buffers"][0]["uri"] = "../up.bin"; }, "uri");
  expect_refused_after([](json& d) { d["buffers"][0]["uri"] = "/dev/zero"; }, "uri");
  expect_refused_after([](json& d) { d["buffers"][0]["uri"] = "data:;base64,!!!!"; }, "uri");
}

TEST_F(ImportBadInput, GltfVertexIndexOutOfRange) {
  expect_refused_after(
      [](json& d) {
        // Reads the positions' bytes as indices.
        d["accessors"][0] = {{"bufferView", 1},
                             {"componentType", 5123},
                             {"count", 6},
                             {"type", "SCALAR"},
                             {"byteOffset", 12}};
      },
      "");
}

TEST_F(ImportBadInput, GltfNodesThatAreNoTree) {
  expect_refused_after([](json& d) { d["nodes"][0]["children"] = {0}; }, "deeply");
  expect_refused_after(
      [](json& d) {
        d["nodes"] = json::parse(R"([{"children":[2]},{"children":[2]},{"mesh":0}])");
      },
      "two parents");
  expect_refused_after([](json& d) { d["nodes"][0]["children"] = {1}; }, "children");
  expect_refused("deep.gltf", std::string(100'000, '['), "deeply");
}

TEST(GltfUri, OnlyPathsThatStayBelowTheirFolder) {
  EXPECT_EQ(decode_relative_uri("a%20b/c.bin"), "a b/c.bin");
  EXPECT_EQ(decode_relative_uri("a/../b.bin"), "b.bin");
  for (const char* uri : {"", "../a", "a/../../b", "/a", "http://a/b", "file:///a", "data:,a", "%",
                          "%zz", "%00a", "a%2"}) {
    EXPECT_EQ(decode_relative_uri(uri), std::nullopt) << uri;
  }
}

TEST(GltfUri, DataUriTellsItsSize) {
  for (std::size_t size = 0; size < 7; ++size) {
    EXPECT_EQ(data_uri_size("data:x/y;base64," + gltf::base64(std::string(size, 'x'))), size);
  }
  for (const char* uri : {"data:x/y,abcd", "data:;base64,abc", "data:;base64,ab=d", "abcd"}) {
    EXPECT_EQ(data_uri_size(uri), std::nullopt) << uri;
  }
}

}  // namespace
}  // namespace relumbre
