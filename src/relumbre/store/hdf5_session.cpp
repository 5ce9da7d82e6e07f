#include "relumbre/store/hdf5_session.h"

namespace relumbre {

namespace {

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

herr_t keep_first(unsigned depth, const H5E_error2_t* entry, void* text) {
  if (depth == 0 && entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  return 0;
}

}  // namespace

Hdf5Session::Hdf5Session() : lock_(library_mutex()) {
  H5Eget_auto2(H5E_DEFAULT, &printer_, &printer_data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Hdf5Session::~Hdf5Session() { H5Eset_auto2(H5E_DEFAULT, printer_, printer_data_); }

hid_t memory_type(Number number) {
  switch (number) {
    case Number::kU8:
      return H5T_NATIVE_UINT8;
    case Number::kU16:
      return H5T_NATIVE_UINT16;
    case Number::kU32:
      return H5T_NATIVE_UINT32;
    case Number::kU64:
      return H5T_NATIVE_UINT64;
    case Number::kI32:
      return H5T_NATIVE_INT32;
    case Number::kF32:
      return H5T_NATIVE_FLOAT;
    case Number::kF64:
      return H5T_NATIVE_DOUBLE;
  }
  return -1;
}

hid_t file_type(Number number) {
  switch (number) {
    case Number::kU8:
      return H5T_STD_U8LE;
    case Number::kU16:
      return H5T_STD_U16LE;
    case Number::kU32:
      return H5T_STD_U32LE;
    case Number::kU64:
      return H5T_STD_U64LE;
    case Number::kI32:
      return H5T_STD_I32LE;
    case Number::kF32:
      return H5T_IEEE_F32LE;
    case Number::kF64:
      return H5T_IEEE_F64LE;
  }
  return -1;
}

std::size_t size_of(Number number) { return H5Tget_size(memory_type(number)); }

std::string hdf5_reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &text);
  return text.empty() ? text : " (HDF5: " + text + ")";
}

}  // namespace relumbre
