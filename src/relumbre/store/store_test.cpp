#include "relumbre/store/store.h"

#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "relumbre/base/sampling.h"
#include "relumbre/base/temporary_folder.h"
#include "relumbre/store/descriptor.h"
#include "relumbre/store/seal.h"
#include "relumbre/store/test_support.h"

namespace relumbre {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

void expect_equal(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.mesh.positions, b.mesh.positions);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  EXPECT_EQ(a.mesh.material, b.mesh.material);
  EXPECT_EQ(a.mesh.object, b.mesh.object);
  EXPECT_EQ(a.mesh.two_sided, b.mesh.two_sided);
  EXPECT_EQ(a.texcoords, b.texcoords);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.shading_normals, b.shading_normals);
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (std::size_t i = 0; i < a.materials.size(); ++i) {
    EXPECT_EQ(a.materials[i].name, b.materials[i].name);
    EXPECT_EQ(a.materials[i].reflectance, b.materials[i].reflectance);
    EXPECT_EQ(a.materials[i].emission, b.materials[i].emission);
    EXPECT_EQ(a.materials[i].texture, b.materials[i].texture);
    EXPECT_EQ(a.materials[i].two_sided, b.materials[i].two_sided);
  }
  ASSERT_EQ(a.textures.size(), b.textures.size());
  for (std::size_t i = 0; i < a.textures.size(); ++i) {
    EXPECT_EQ(a.textures[i].name, b.textures[i].name);
    EXPECT_EQ(a.textures[i].width, b.textures[i].width);
    EXPECT_EQ(a.textures[i].height, b.textures[i].height);
    EXPECT_EQ(a.textures[i].rgb, b.textures[i].rgb);
  }
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].name, b.objects[i].name);
  }
}

void expect_equal_lights(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (std::size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_EQ(a.lights[i].name, b.lights[i].name);
    EXPECT_EQ(a.lights[i].type, b.lights[i].type);
    EXPECT_EQ(a.lights[i].position, b.lights[i].position);
    EXPECT_EQ(a.lights[i].direction, b.lights[i].direction);
    EXPECT_EQ(a.lights[i].inner_deg, b.lights[i].inner_deg);
    EXPECT_EQ(a.lights[i].outer_deg, b.lights[i].outer_deg);
    EXPECT_EQ(a.lights[i].color, b.lights[i].color);
    EXPECT_EQ(a.lights[i].intensity, b.lights[i].intensity);
    EXPECT_EQ(a.lights[i].on, b.lights[i].on);
    EXPECT_EQ(a.lights[i].object, b.lights[i].object);
  }
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (std::size_t i = 0; i < a.cameras.size(); ++i) {
    EXPECT_EQ(a.cameras[i].name, b.cameras[i].name);
    EXPECT_EQ(a.cameras[i].eye, b.cameras[i].eye);
    EXPECT_EQ(a.cameras[i].vfov_deg, b.cameras[i].vfov_deg);
  }
}

void expect_equal(const Tessellation& a, const Tessellation& b) {
  EXPECT_EQ(a.positions, b.positions);
  ASSERT_EQ(a.facets.size(), b.facets.size());
  EXPECT_EQ(std::memcmp(a.facets.data(), b.facets.data(), a.facets.size() * sizeof(Facet)), 0);
  EXPECT_EQ(a.facet_offsets, b.facet_offsets);
  EXPECT_EQ(a.patch_offsets, b.patch_offsets);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.centroid, b.centroid);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.locator.roots, b.locator.roots);
  EXPECT_EQ(a.locator.nodes, b.locator.nodes);
}

void expect_equal(const SparseCounts& a, const SparseCounts& b) {
  EXPECT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.row_offsets, b.row_offsets);
  EXPECT_EQ(a.column, b.column);
  EXPECT_EQ(a.count, b.count);
}

void expect_equal(const BakedScene& a, const BakedScene& b) {
  expect_equal(a.scene, b.scene);
  expect_equal_lights(a.scene, b.scene);
  expect_equal(a.tessellation, b.tessellation);
  EXPECT_EQ(a.reflectance, b.reflectance);
  EXPECT_EQ(a.emission, b.emission);
  expect_equal(a.counts, b.counts);
  EXPECT_EQ(a.settings, b.settings);
  EXPECT_EQ(a.energy.rays, b.energy.rays);
  EXPECT_EQ(a.energy.reciprocity_error, b.energy.reciprocity_error);
  EXPECT_EQ(a.energy.escaped, b.energy.escaped);
}

/// The hand-made scene with `elements` elements of one facet each, a patch each, random counts.
BakedScene many_elements(std::size_t elements, std::uint32_t rays) {
  BakedScene baked = hand_made_scene();
  Tessellation& t = baked.tessellation;
  t.facets.assign(elements, t.facets.back());
  t.locator = {{~0, FacetLocator::kMissing, ~1, FacetLocator::kMissing}, {}};
  t.facet_offsets.resize(elements + 1);
  for (std::uint32_t i = 0; i <= elements; ++i) t.facet_offsets[i] = i;
  t.patch_offsets = t.facet_offsets;
  t.area.assign(elements, 0.5F);
  t.centroid.assign(elements, {});
  t.normal.assign(elements, {0, 0, 1});
  baked.reflectance.assign(elements, Rgb(0.5F));
  baked.emission.assign(elements, Rgb());
  baked.counts = {};
  baked.counts.columns = elements;
  baked.counts.rays = rays;
  RandomStream random(elements);
  for (std::size_t i = 0; i < elements; ++i) {
    for (std::size_t j = random.bits() % elements, left = 5; j < elements && left > 0;
         j += 1 + random.bits() % elements, --left) {
      baked.counts.column.push_back(static_cast<std::uint32_t>(j));
      baked.counts.count.push_back(rays / 5);
    }
    baked.counts.row_offsets.push_back(baked.counts.column.size());
  }
  baked.settings.patches = baked.settings.elements = elements;
  baked.settings.rays = rays;
  return baked;
}

class Store : public testing::Test {
 protected:
  /// What reading the file says, without the file's name in front.
  std::string refusal() {
    const std::string message = file_error([&] { (void)read_store(path_); });
    EXPECT_TRUE(message.empty() || message.starts_with(path_.string() + ": ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
    return message;
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_ / "scene.h5";
};

TEST_F(Store, GivesBackWhatWasWritten) {
  const BakedScene baked = hand_made_scene();
  write_store(path_, baked);
  expect_equal(read_store(path_), baked);
  EXPECT_EQ(files_in(folder_.path()), 1U);
}

TEST_F(Store, KeepsBareScenes) {
  BakedScene baked = hand_made_scene();
  baked.scene.texcoords.clear();
  baked.scene.colors.clear();
  baked.scene.shading_normals.clear();
  baked.scene.textures.clear();
  baked.scene.materials[0].texture = kNone;
  baked.scene.lights.clear();
  baked.scene.cameras.clear();
  baked.settings.scene.clear();
  baked.counts.row_offsets.assign(5, 0);
  baked.counts.column.clear();
  baked.counts.count.clear();
  write_store(path_, baked);
  expect_equal(read_store(path_), baked);
}

TEST_F(Store, KeepsIndicesAndCountsBeyondSixteenBits) {
  const BakedScene baked = many_elements(70001, 500000);
  write_store(path_, baked);
  expect_equal(read_store(path_), baked);
}

TEST_F(Store, SameContentsGiveTheSameBytes) {
  const BakedScene baked = hand_made_scene();
  write_store(path_, baked);
  const std::string first = bytes_of(path_);
  write_store(path_, baked);
  EXPECT_EQ(bytes_of(path_), first);
}

TEST_F(Store, BlocksOfCountsGiveTheSameBytesAsOnePiece) {
  const BakedScene baked = many_elements(101, 100);
  write_store(path_, baked);
  const fs::path other = folder_ / "other.h5";
  const auto in_single_rows = [&](const std::function<void(const SparseCounts&)>& visit) {
    for (std::size_t i = 0; i < baked.counts.rows(); ++i) {
      SparseCounts row;
      row.columns = baked.counts.columns;
      row.rays = baked.counts.rays;
      const auto columns = baked.counts.row_columns(i), counts = baked.counts.row_counts(i);
      row.column.assign(columns.begin(), columns.end());
      row.count.assign(counts.begin(), counts.end());
      row.row_offsets.push_back(columns.size());
      visit(row);
    }
  };
  write_store(other, {baked.scene, baked.tessellation, baked.reflectance, baked.emission,
                      baked.settings, baked.energy,
                      CountsStream{101, 101, 100, baked.counts.nonzeros(), 20, in_single_rows}});
  EXPECT_EQ(bytes_of(path_), bytes_of(other));
}

TEST_F(Store, SummaryAgreesWithTheWhole) {
  const BakedScene baked = hand_made_scene();
  write_store(path_, baked);
  const StoreSummary summary = read_store_summary(path_);
  EXPECT_EQ(summary.settings, baked.settings);
  EXPECT_EQ(summary.energy.escaped, baked.energy.escaped);
  EXPECT_EQ(summary.triangles, 2U);
  EXPECT_EQ(summary.vertices, 6U);
  EXPECT_EQ(summary.facets, 5U);
  EXPECT_EQ(summary.nonzeros, 4U);
  EXPECT_EQ(summary.geometry_hash, baked.scene.geometry_hash());
  EXPECT_EQ(summary.file_bytes, fs::file_size(path_));
  EXPECT_EQ(summary.content_hash, verify_seal(path_));
  expect_equal_lights(summary.description, baked.scene);
}

TEST_F(Store, RefusesWhatIsNoStore) {
  EXPECT_THAT(refusal(), HasSubstr("No such file"));
  put_bytes(path_, "");
  EXPECT_THAT(refusal(), HasSubstr("is not a Relumbre store"));
  put_bytes(path_, std::string(5000, 'x'));
  EXPECT_THAT(refusal(), HasSubstr("is not a Relumbre store"));
  put_bytes(path_, "\x89HDF\r\n\x1a\n" + std::string(5000, '\0'));
  EXPECT_THAT(refusal(), HasSubstr("is not a Relumbre store"));
  fs::remove(path_);
  fs::create_directory(path_);
  EXPECT_THAT(refusal(), HasSubstr("is not a regular file"));
}

TEST_F(Store, RefusesANewerVersionAndNamesBoth) {
  write_store(path_, hand_made_scene());
  std::string bytes = bytes_of(path_);
  bytes[16] = 7;
  put_bytes(path_, bytes);
  EXPECT_THAT(refusal(), AllOf(HasSubstr("version 7"), HasSubstr("version 1")));
}

TEST_F(Store, RefusesEveryTruncation) {
  write_store(path_, hand_made_scene());
  const std::string bytes = bytes_of(path_);
  for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 7) {
    put_bytes(path_, bytes.substr(0, length));
    EXPECT_THAT(refusal(), HasSubstr(length < kSealBytes ? "is not a Relumbre store" : "truncated"))
        << length;
  }
  put_bytes(path_, bytes + "x");
  EXPECT_THAT(refusal(), HasSubstr("longer than it should be"));
}

TEST_F(Store, RefusesEveryFlippedByte) {
  write_store(path_, hand_made_scene());
  const std::string bytes = bytes_of(path_);
  const Descriptor file = open_for_update(path_);
  for (std::size_t i = 0; i < bytes.size(); i += i < kSealBytes ? 1 : 13) {
    char byte = static_cast<char>(bytes[i] ^ (1 << i % 8));
    write_at(file.get(), i, std::as_bytes(std::span(&byte, 1)), path_);
    EXPECT_THROW((void)verify_seal(path_), FileError) << i;
    write_at(file.get(), i, std::as_bytes(std::span(&bytes[i], 1)), path_);
  }
  EXPECT_EQ(refusal(), "");
}

TEST_F(Store, FullDiskLeavesNothingBehind) {
  const BakedScene baked = many_elements(3001, 100);
  write_store(path_, baked);
  const std::size_t whole = fs::file_size(path_);
  fs::remove(path_);
  for (const std::size_t room :
       {std::size_t{0}, std::size_t{600}, std::size_t{3000}, whole / 2, whole - 1}) {
    const FullDisk disk(room);
    EXPECT_THAT(file_error([&] { write_store(path_, baked); }),
                AllOf(HasSubstr(path_.string()), HasSubstr("File too large")));
    EXPECT_EQ(files_in(folder_.path()), 0U) << room;
  }
  write_store(path_, baked);
  expect_equal(read_store(path_), baked);
}

TEST_F(Store, FullDiskKeepsTheFormerStore) {
  write_store(path_, hand_made_scene());
  const std::string before = bytes_of(path_);
  {
    const FullDisk disk(2000);
    EXPECT_THROW(write_store(path_, many_elements(101, 100)), FileError);
  }
  EXPECT_EQ(bytes_of(path_), before);
}

TEST_F(Store, CancelledWriteLeavesNothing) {
  struct Stop : Progress {
    [[nodiscard]] bool cancelled() const override { return true; }
  } stop;
  EXPECT_THROW(write_store(path_, hand_made_scene(), stop), Cancelled);
  EXPECT_EQ(files_in(folder_.path()), 0U);
}

TEST_F(Store, MissingFolderIsNamed) {
  const fs::path nowhere = folder_ / "nowhere" / "scene.h5";
  EXPECT_THAT(file_error([&] { write_store(nowhere, hand_made_scene()); }),
              HasSubstr(nowhere.string()));
}

TEST_F(Store, LightsOfFilesAreRefused) {
  BakedScene baked = hand_made_scene();
  baked.scene.lights[0].type = LightType::kSky;
  baked.scene.lights[0].file = "sky.exr";
  EXPECT_THROW(write_store(path_, baked), ValueError);
  EXPECT_EQ(files_in(folder_.path()), 0U);
}

TEST_F(Store, ManyThreadsReadAtOnce) {
  const BakedScene baked = hand_made_scene();
  write_store(path_, baked);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int j = 0; j < 5; ++j) expect_equal(read_store(path_), baked);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

/// One way in which a baked scene can be wrong.
struct Fault {
  const char* what;
  std::function<void(BakedScene&)> apply;
};

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

const Fault kFaults[] = {
    {"vertex index", [](BakedScene& b) { b.scene.mesh.triangles[1][2] = 6; }},
    {"vertex", [](BakedScene& b) { b.scene.mesh.positions[0].y = kNan; }},
    {"material index", [](BakedScene& b) { b.scene.mesh.material[0] = 2; }},
    {"materials missing", [](BakedScene& b) { b.scene.mesh.material.pop_back(); }},
    {"object index", [](BakedScene& b) { b.scene.mesh.object[0] = 2; }},
    {"two_sided", [](BakedScene& b) { b.scene.mesh.two_sided[0] = 2; }},
    {"texcoords", [](BakedScene& b) { b.scene.texcoords.pop_back(); }},
    {"colors", [](BakedScene& b) { b.scene.colors.pop_back(); }},
    {"colors", [](BakedScene& b) { b.scene.colors[2].y = 1.5F; }},
    {"normals", [](BakedScene& b) { b.scene.shading_normals[3].x = kNan; }},
    {"albedo", [](BakedScene& b) { b.scene.materials[0].reflectance.x = 1; }},
    {"texture index", [](BakedScene& b) { b.scene.materials[0].texture = 2; }},
    {"texels", [](BakedScene& b) { b.scene.textures[0].rgb.pop_back(); }},
    {"light", [](BakedScene& b) { b.scene.lights[0].intensity = kNan; }},
    {"emitter object", [](BakedScene& b) { b.scene.lights[1].object = 2; }},
    {"camera", [](BakedScene& b) { b.scene.cameras[0].vfov_deg = 180; }},
    {"facet corner", [](BakedScene& b) { b.tessellation.facets[0].corners[1] = 9; }},
    {"facet triangle", [](BakedScene& b) { b.tessellation.facets[0].triangle = 2; }},
    {"facet side", [](BakedScene& b) { b.tessellation.facets[0].back = 2; }},
    {"facet offsets fall", [](BakedScene& b) { b.tessellation.facet_offsets[2] = 1; }},
    {"facet offsets end", [](BakedScene& b) { b.tessellation.facet_offsets[4] = 6; }},
    {"facet offsets begin", [](BakedScene& b) { b.tessellation.facet_offsets[0] = 1; }},
    {"patch offsets", [](BakedScene& b) { b.tessellation.patch_offsets[1] = 4; }},
    {"no patches", [](BakedScene& b) { b.tessellation.patch_offsets.clear(); }},
    {"area", [](BakedScene& b) { b.tessellation.area[2] = 0; }},
    {"centroid", [](BakedScene& b) { b.tessellation.centroid.pop_back(); }},
    {"normal", [](BakedScene& b) { b.tessellation.normal[0].z = kNan; }},
    {"locator facet", [](BakedScene& b) { b.tessellation.locator.nodes[3] = ~5; }},
    {"locator node", [](BakedScene& b) { b.tessellation.locator.roots[2] = 1; }},
    {"locator cycle", [](BakedScene& b) { b.tessellation.locator.nodes[3] = 0; }},
    {"locator shared node", [](BakedScene& b) { b.tessellation.locator.roots[2] = 0; }},
    {"locator missing child",
     [](BakedScene& b) { b.tessellation.locator.nodes[3] = FacetLocator::kMissing; }},
    {"locator roots", [](BakedScene& b) { b.tessellation.locator.roots.pop_back(); }},
    {"locator nodes", [](BakedScene& b) { b.tessellation.locator.nodes.pop_back(); }},
    {"locator depth",
     [](BakedScene& b) {
       auto& nodes = b.tessellation.locator.nodes;
       for (std::int32_t i = 0; i < 70; ++i) {
         nodes[static_cast<std::size_t>(4 * i)] = i + 1;
         nodes.insert(nodes.end(), 4, ~0);
       }
     }},
    {"reflectance", [](BakedScene& b) { b.reflectance[1].y = 1; }},
    {"emission", [](BakedScene& b) { b.emission[1].y = -1; }},
    {"emissions missing", [](BakedScene& b) { b.emission.pop_back(); }},
    {"settings patches", [](BakedScene& b) { b.settings.patches = 3; }},
    {"settings elements", [](BakedScene& b) { b.settings.elements = 3; }},
    {"settings rays", [](BakedScene& b) { b.settings.rays = 17; }},
    {"column", [](BakedScene& b) { b.counts.column[0] = 2; }},
    {"columns", [](BakedScene& b) { b.counts.columns = 1; }},
    {"columns order", [](BakedScene& b) { b.counts.column[3] = 0; }},
    {"count", [](BakedScene& b) { b.counts.count[1] = 17; }},
    {"no count", [](BakedScene& b) { b.counts.count[1] = 0; }},
    {"row offsets", [](BakedScene& b) { b.counts.row_offsets[2] = 3; }},
    {"rows", [](BakedScene& b) { b.counts.row_offsets.pop_back(); }},
};

TEST_F(Store, RefusesToWriteWhatCannotBeTrue) {
  for (const Fault& fault : kFaults) {
    BakedScene baked = hand_made_scene();
    fault.apply(baked);
    EXPECT_THROW(write_store(path_, baked), ValueError) << fault.what;
    EXPECT_EQ(files_in(folder_.path()), 0U) << fault.what;
  }
}

}  // namespace
}  // namespace relumbre
