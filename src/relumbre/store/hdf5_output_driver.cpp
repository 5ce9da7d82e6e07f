#include "relumbre/store/hdf5_output_driver.h"

#include <algorithm>
#include <cerrno>

#include <hdf5.h>
#include <unistd.h>
#if __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h>  // where HDF5 1.14 keeps the driver interface
#endif

namespace relumbre {

namespace {

static_assert(std::is_same_v<hid_t, Hdf5Id>);

/// What travels in the file-access properties: HDF5 copies it byte by byte.
struct DriverInfo {
  OutputSink* sink;
};

/// HDF5 knows the file by its first member.
struct OutputFile {
  H5FD_t base;
  OutputSink* sink;
  haddr_t allocated;  ///< where HDF5's address space ends
  haddr_t end;        ///< where the file ends
};

OutputFile& self(H5FD_t* file) { return *reinterpret_cast<OutputFile*>(file); }
const OutputFile& self(const H5FD_t* file) { return *reinterpret_cast<const OutputFile*>(file); }

H5FD_t* open_file(const char*, unsigned, hid_t access, haddr_t) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access));
  if (info == nullptr) return nullptr;
  return &(new OutputFile{{}, info->sink, 0, 0})->base;
}

herr_t close_file(H5FD_t* file) {
  delete &self(file);
  return 0;
}

int compare_files(const H5FD_t* a, const H5FD_t* b) { return a < b ? -1 : a > b ? 1 : 0; }

herr_t query_features(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t get_allocated(const H5FD_t* file, H5FD_mem_t) { return self(file).allocated; }

herr_t set_allocated(H5FD_t* file, H5FD_mem_t, haddr_t address) {
  self(file).allocated = address;
  return 0;
}

haddr_t get_end(const H5FD_t* file, H5FD_mem_t) { return self(file).end; }

herr_t read_file(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size, void* buffer) {
  self(file).sink->read(address, {static_cast<std::byte*>(buffer), size});
  return 0;
}

herr_t write_file(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t address, size_t size,
                  const void* buffer) {
  self(file).sink->write(address, {static_cast<const std::byte*>(buffer), size});
  self(file).end = std::max(self(file).end, address + size);
  return 0;
}

herr_t truncate_file(H5FD_t* file, hid_t, hbool_t) {
  if (self(file).end == self(file).allocated) return 0;
  self(file).sink->resize(self(file).allocated);
  self(file).end = self(file).allocated;
  return 0;
}

/// HDF5 1.14 put a version and a registered value in front.
template <class Driver>
void stamp(Driver& driver) {
  if constexpr (requires { driver.version; }) {
    driver.version = 1;
    driver.value = 511;  // the last of those reserved for testing
  }
}

H5FD_class_t make_driver() {
  H5FD_class_t driver{};
  stamp(driver);
  driver.name = "relumbre-output";
  driver.maxaddr = HADDR_MAX / 2;
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(DriverInfo);
  driver.open = open_file;
  driver.close = close_file;
  driver.cmp = compare_files;
  driver.query = query_features;
  driver.get_eoa = get_allocated;
  driver.set_eoa = set_allocated;
  driver.get_eof = get_end;
  driver.read = read_file;
  driver.write = write_file;
  driver.truncate = truncate_file;
  const H5FD_mem_t one_free_list_each[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(one_free_list_each), std::end(one_free_list_each), driver.fl_map);
  return driver;
}

}  // namespace

void OutputSink::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (error_ == 0) error_ = try_write_at(descriptor_.get(), offset, bytes);
}

void OutputSink::resize(std::uint64_t length) {
  if (error_ == 0 && ::ftruncate(descriptor_.get(), static_cast<off_t>(length)) != 0) {
    error_ = errno;
  }
}

void OutputSink::read(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t got =
        ::pread(descriptor_.get(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    bytes = bytes.subspan(static_cast<std::size_t>(got));
    offset += static_cast<std::uint64_t>(got);
  }
  std::fill(bytes.begin(), bytes.end(), std::byte{0});
}

Hdf5Id use_output_driver(Hdf5Id access, OutputSink& sink) {
  const H5FD_class_t driver = make_driver();
  const hid_t id = H5FDregister(&driver);
  const DriverInfo info{&sink};
  if (id >= 0 && H5Pset_driver(access, id, &info) < 0) {
    H5FDunregister(id);
    return -1;
  }
  return id;
}

}  // namespace relumbre
