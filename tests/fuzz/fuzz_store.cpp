// What begins like a store is read as one: read_store() and read_store_summary() refuse it with a
// FileError or return a scene. That is done with the bytes as they are, and again under a seal that
// fits them, so that what lies behind the seal is reached. Anything else is a list of edits to a
// good scene: validate() refuses the result with an Error, or all that is computed from it stays
// inside its arrays.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "relumbre/base/error.h"
#include "relumbre/store/descriptor.h"
#include "relumbre/store/seal.h"
#include "relumbre/store/store.h"
#include "relumbre/store/test_support.h"

namespace relumbre {
namespace {

void read_both(const std::filesystem::path& file) {
  try {
    (void)read_store_summary(file);
    (void)read_store(file);
  } catch (const FileError&) {
  }
}

void read_as_store(std::string_view bytes) {
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("fuzz_store." + std::to_string(::getpid()) + ".h5");
  put_bytes(file, std::string(bytes));
  read_both(file);
  if (bytes.size() > kSealBytes) {
    write_seal(open_for_update(file).get(), file);
    read_both(file);
  }
  std::filesystem::remove(file);
}

/// Four bytes of any array of numbers; or, at index 255, its length, one less.
struct Edit {
  std::uint8_t array, index;
  std::uint32_t value;
};

template <class T>
void apply(const Edit& edit, std::uint8_t array, std::vector<T>& values) {
  if (edit.array != array || values.empty()) return;
  if (edit.index == 255) return values.pop_back();
  const std::span bytes = std::as_writable_bytes(std::span(values));
  const std::size_t at = 4 * std::size_t{edit.index} % bytes.size();
  std::memcpy(&bytes[at], &edit.value, std::min(sizeof edit.value, bytes.size() - at));
}

void apply(const Edit& edit, BakedScene& baked) {
  std::uint8_t array = 0;
  const auto next = [&](auto& values) { apply(edit, array++, values); };
  next(baked.scene.mesh.positions);
  next(baked.scene.mesh.triangles);
  next(baked.scene.mesh.material);
  next(baked.scene.mesh.object);
  next(baked.scene.mesh.two_sided);
  next(baked.scene.texcoords);
  next(baked.tessellation.facets);
  next(baked.tessellation.facet_offsets);
  next(baked.tessellation.patch_offsets);
  next(baked.tessellation.area);
  next(baked.tessellation.locator.roots);
  next(baked.tessellation.locator.nodes);
  next(baked.reflectance);
  next(baked.emission);
  next(baked.counts.row_offsets);
  next(baked.counts.column);
  next(baked.counts.count);
}

/// Touches what users of a baked scene touch.
void use(const BakedScene& baked) {
  const Tessellation& t = baked.tessellation;
  const std::vector<std::uint32_t> element = t.element_of_facet(), patch = t.patch_of_element();
  for (std::uint32_t triangle = 0; triangle < baked.scene.mesh.triangles.size(); ++triangle) {
    (void)baked.scene.reflectance(triangle, 0.25F, 0.25F);
    for (const bool back : {false, true}) {
      const std::uint32_t facet = t.locate(triangle, back, 0.3F, 0.3F);
      if (facet != kNone && patch[element[facet]] >= t.patches()) std::abort();
    }
  }
  std::vector<std::uint64_t> arrivals(t.patches());
  for (std::size_t i = 0; i < t.elements(); ++i) {
    for (const Facet& facet : t.facets_of(i)) (void)t.positions[facet.corners[2]];
    for (const std::uint32_t p : baked.counts.row_columns(i)) ++arrivals[p];
  }
}

void edit_a_scene(std::span<const std::uint8_t> bytes) {
  BakedScene baked = hand_made_scene();
  for (; bytes.size() >= 6; bytes = bytes.subspan(6)) {
    Edit edit{bytes[0], bytes[1], 0};
    std::memcpy(&edit.value, &bytes[2], sizeof edit.value);
    apply(edit, baked);
  }
  try {
    validate(baked);
  } catch (const Error&) {
    return;
  }
  use(baked);
}

}  // namespace
}  // namespace relumbre

// HDF5 1.10 forgets some of its own memory when it refuses a damaged file.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (bytes.starts_with("RELUMBRE") || bytes.starts_with("\x89HDF")) {
    relumbre::read_as_store(bytes);
  } else {
    relumbre::edit_a_scene({data, size});
  }
  return 0;
}
