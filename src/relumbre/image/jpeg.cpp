#include "relumbre/image/jpeg.h"

#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>
// jerror.h needs jpeglib.h before it.
#include <jerror.h>

#include "relumbre/base/error.h"

namespace relumbre {

namespace {

constexpr int kMaxScans = 100;  // each scan of a hostile file costs a pass over the whole picture

/// libjpeg reports an error by calling error_exit, which must not return. It jumps back to the
/// setjmp of read_header or read_rows below; neither frame holds anything with a destructor.
struct Decoder {
  jpeg_decompress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg_progress_mgr progress;
  std::jmp_buf trap;
  char message[JMSG_LENGTH_MAX];

  ~Decoder() { jpeg_destroy_decompress(&jpeg); }
};

void on_error(j_common_ptr jpeg) {
  auto* decoder = static_cast<Decoder*>(jpeg->client_data);
  jpeg->err->format_message(jpeg, decoder->message);
  std::longjmp(decoder->trap, 1);
}

/// Warnings that mean missing picture data are errors; others (stray bytes) are let pass.
void on_message(j_common_ptr jpeg, int level) {
  const int code = jpeg->err->msg_code;
  if (level < 0 && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER)) on_error(jpeg);
}

void on_progress(j_common_ptr jpeg) {
  auto* decoder = static_cast<Decoder*>(jpeg->client_data);
  if (decoder->jpeg.input_scan_number <= kMaxScans) return;
  std::snprintf(decoder->message, sizeof decoder->message, "more than %d scans", kMaxScans);
  std::longjmp(decoder->trap, 1);
}

/// False if the header is damaged; then decoder.message says how.
bool read_header(Decoder& decoder, const unsigned char* bytes, unsigned long size) {
  decoder.jpeg.err = jpeg_std_error(&decoder.errors);
  decoder.errors.error_exit = on_error;
  decoder.errors.emit_message = on_message;
  decoder.jpeg.client_data = &decoder;
  if (setjmp(decoder.trap) != 0) return false;
  jpeg_create_decompress(&decoder.jpeg);  // clears all but err and client_data
  decoder.progress.progress_monitor = on_progress;
  decoder.jpeg.progress = &decoder.progress;
  jpeg_mem_src(&decoder.jpeg, bytes, size);
  jpeg_read_header(&decoder.jpeg, TRUE);
  decoder.jpeg.out_color_space = JCS_RGB;
  return true;
}

/// Decodes into width · height · 3 bytes. False if the picture is damaged.
bool read_rows(Decoder& decoder, unsigned char* rgb) {
  if (setjmp(decoder.trap) != 0) return false;
  jpeg_start_decompress(&decoder.jpeg);
  while (decoder.jpeg.output_scanline < decoder.jpeg.output_height) {
    JSAMPROW row = rgb + std::size_t{decoder.jpeg.output_scanline} * decoder.jpeg.output_width * 3;
    jpeg_read_scanlines(&decoder.jpeg, &row, 1);
  }
  jpeg_finish_decompress(&decoder.jpeg);
  return true;
}

}  // namespace

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8\xFF"); }

Raster decode_jpeg(std::string_view bytes, const std::string& name) {
  if (!is_jpeg(bytes)) throw FileError(name, bytes.empty() ? "is empty" : "is not a JPEG image");
  Decoder decoder{};
  const auto fail = [&] {
    throw FileError(name, "is a damaged or unsupported JPEG: " + std::string(decoder.message));
  };
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  if (!read_header(decoder, data, static_cast<unsigned long>(bytes.size()))) fail();
  const std::uint32_t width = decoder.jpeg.image_width, height = decoder.jpeg.image_height;
  check_raster_size(name, width, height, bytes.size());
  Raster raster{width, height, std::vector<std::uint8_t>(std::size_t{width} * height * 3)};
  if (!read_rows(decoder, raster.rgb.data())) fail();
  return raster;
}

}  // namespace relumbre
