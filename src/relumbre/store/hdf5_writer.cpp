#include "relumbre/store/hdf5_writer.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "relumbre/base/atomic_file.h"
#include "relumbre/base/error.h"
#include "relumbre/store/hdf5_output_driver.h"
#include "relumbre/store/hdf5_session.h"

namespace relumbre {
namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kChunkNumbers = std::uint64_t{1} << 18;
constexpr unsigned kDeflateLevel = 1;

/// Whole rows, about kChunkNumbers numbers.
Extent chunk_of(const Extent& extent) {
  Extent chunk = extent;
  const std::uint64_t row =
      std::accumulate(extent.begin() + 1, extent.end(), std::uint64_t{1}, std::multiplies<>());
  chunk[0] =
      std::clamp<std::uint64_t>(kChunkNumbers / std::max<std::uint64_t>(row, 1), 1, extent[0]);
  return chunk;
}

Hdf5Handle dataset_properties() {
  Hdf5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), 0);
  return properties;
}

Hdf5Handle text_type(std::string_view text) {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(text.size(), 1));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

}  // namespace

struct Hdf5Writer::Impl {
  fs::path target;
  AtomicFile file;
  OutputSink sink;
  Hdf5Session session;
  Hdf5Handle driver, handle;

  explicit Impl(const fs::path& target_)
      : target(target_), file(target_), sink(open_for_update(file.path())) {}

  void create(std::size_t user_block);

  /// Throws if the disk failed or HDF5 did.
  void require(bool success, const std::string& what) const {
    if (sink.error() != 0) throw FileError(target.string(), std::strerror(sink.error()));
    if (!success) throw FileError(target.string(), "cannot write " + what + hdf5_reason());
  }

  [[nodiscard]] Hdf5Handle create_dataset(const std::string& path, hid_t type, hid_t space,
                                          hid_t properties) const {
    Hdf5Handle dataset(
        H5Dcreate2(handle.get(), path.c_str(), type, space, H5P_DEFAULT, properties, H5P_DEFAULT),
        H5Dclose);
    require(dataset.valid(), path);
    return dataset;
  }

  [[nodiscard]] Hdf5Handle create_array(const std::string& path, Number number,
                                        const Extent& extent) const;
  void write_attribute(const std::string& group, const std::string& name, hid_t type,
                       hid_t type_in_memory, const void* value) const;
};

void Hdf5Writer::Impl::create(std::size_t user_block) {
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  driver = Hdf5Handle(use_output_driver(access.get(), sink), H5FDunregister);
  require(driver.valid(), "the file");
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110);
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  const Hdf5Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_userblock(creation.get(), user_block);
  H5Pset_obj_track_times(creation.get(), 0);  // the same contents give the same bytes
  handle = Hdf5Handle(H5Fcreate(file.path().c_str(), H5F_ACC_TRUNC, creation.get(), access.get()),
                      H5Fclose);
  require(handle.valid(), "the file");
}

Hdf5Handle Hdf5Writer::Impl::create_array(const std::string& path, Number number,
                                          const Extent& extent) const {
  const Hdf5Handle properties = dataset_properties();
  const bool empty = std::find(extent.begin(), extent.end(), 0U) != extent.end();
  if (!empty) {  // nothing cannot be cut into chunks
    const Extent chunk = chunk_of(extent);
    const std::vector<hsize_t> sides(chunk.begin(), chunk.end());
    H5Pset_chunk(properties.get(), static_cast<int>(sides.size()), sides.data());
    H5Pset_shuffle(properties.get());
    H5Pset_deflate(properties.get(), kDeflateLevel);
    H5Pset_fletcher32(properties.get());
  }
  const std::vector<hsize_t> sides(extent.begin(), extent.end());
  const Hdf5Handle space(H5Screate_simple(static_cast<int>(sides.size()), sides.data(), nullptr),
                         H5Sclose);
  return create_dataset(path, file_type(number), space.get(), properties.get());
}

void Hdf5Writer::Impl::write_attribute(const std::string& group, const std::string& name,
                                       hid_t type, hid_t type_in_memory, const void* value) const {
  const Hdf5Handle object(H5Oopen(handle.get(), group.c_str(), H5P_DEFAULT), H5Oclose);
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle attribute(
      H5Acreate2(object.get(), name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  require(attribute.valid() && H5Awrite(attribute.get(), type_in_memory, value) >= 0,
          group + " attribute " + name);
}

Hdf5Writer::Hdf5Writer(const fs::path& target, std::size_t user_block)
    : impl_(std::make_unique<Impl>(target)) {
  impl_->create(user_block);
}

Hdf5Writer::~Hdf5Writer() = default;

void Hdf5Writer::make_group(const std::string& path) {
  const Hdf5Handle properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), 0);
  const Hdf5Handle group(
      H5Gcreate2(impl_->handle.get(), path.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Gclose);
  impl_->require(group.valid(), path);
}

void Hdf5Writer::write_array(const std::string& path, Number number, const Extent& extent,
                             const void* data) {
  const Hdf5Handle dataset = impl_->create_array(path, number, extent);
  const bool empty = std::find(extent.begin(), extent.end(), 0U) != extent.end();
  impl_->require(empty || H5Dwrite(dataset.get(), memory_type(number), H5S_ALL, H5S_ALL,
                                   H5P_DEFAULT, data) >= 0,
                 path);
}

void Hdf5Writer::write_text(const std::string& path, std::string_view text) {
  const Hdf5Handle type = text_type(text);
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Handle properties = dataset_properties();
  const Hdf5Handle dataset = impl_->create_dataset(path, type.get(), space.get(), properties.get());
  const std::string terminated(text);
  impl_->require(
      H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, terminated.c_str()) >= 0,
      path);
}

void Hdf5Writer::attribute(const std::string& group, const std::string& name, Number number,
                           const void* value) {
  impl_->write_attribute(group, name, file_type(number), memory_type(number), value);
}

void Hdf5Writer::text_attribute(const std::string& group, const std::string& name,
                                std::string_view text) {
  const Hdf5Handle type = text_type(text);
  const std::string terminated(text);
  impl_->write_attribute(group, name, type.get(), type.get(), terminated.c_str());
}

void Hdf5Writer::close() {
  const hid_t file = impl_->handle.get();
  impl_->require(H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0, "the file");
  impl_->handle = {};
  impl_->require(true, "the file");
}

int Hdf5Writer::descriptor() const { return impl_->sink.descriptor(); }

void Hdf5Writer::commit() { impl_->file.commit(); }

struct Hdf5Writer::Column::State {
  const Impl& writer;
  std::string path;
  Hdf5Handle dataset;
  std::uint64_t size;
  std::uint64_t written = 0;
  std::vector<std::uint32_t> pending;  ///< less than a chunk

  void flush();
};

/// Writes what is pending: a whole chunk, or the last one.
void Hdf5Writer::Column::State::flush() {
  if (pending.empty()) return;
  const hsize_t start = written, count = pending.size();
  const Hdf5Handle in_file(H5Dget_space(dataset.get()), H5Sclose);
  const Hdf5Handle in_memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const bool written_well =
      H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, &start, nullptr, &count, nullptr) >= 0 &&
      H5Dwrite(dataset.get(), H5T_NATIVE_UINT32, in_memory.get(), in_file.get(), H5P_DEFAULT,
               pending.data()) >= 0;
  writer.require(written_well, path);
  written += count;
  pending.clear();
}

Hdf5Writer::Column::Column(std::unique_ptr<State> state) : state_(std::move(state)) {}
Hdf5Writer::Column::Column(Column&&) noexcept = default;
Hdf5Writer::Column::~Column() = default;

Hdf5Writer::Column Hdf5Writer::column(const std::string& path, Number number, std::uint64_t size) {
  auto state = std::make_unique<Column::State>(
      Column::State{*impl_, path, impl_->create_array(path, number, {size}), size, 0, {}});
  state->pending.reserve(std::min(kChunkNumbers, size));
  return Column(std::move(state));
}

void Hdf5Writer::Column::append(std::span<const std::uint32_t> values) {
  if (values.size() > state_->size - state_->written - state_->pending.size()) {
    throw ShapeError(fmt::format("more than {} values for {}", state_->size, state_->path));
  }
  while (!values.empty()) {
    auto& pending = state_->pending;
    const auto taken =
        values.first(std::min<std::size_t>(values.size(), kChunkNumbers - pending.size()));
    pending.insert(pending.end(), taken.begin(), taken.end());
    values = values.subspan(taken.size());
    if (pending.size() == kChunkNumbers) state_->flush();
  }
}

void Hdf5Writer::Column::finish() {
  state_->flush();
  if (state_->written == state_->size) return;
  throw ShapeError(
      fmt::format("{} of {} values for {}", state_->written, state_->size, state_->path));
}

}  // namespace relumbre
