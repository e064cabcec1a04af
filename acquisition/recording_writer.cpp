#include <new>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <zlib.h>

#include "acquisition/header_text.h"
#include "acquisition/metaimage.h"
#include "acquisition/nrrd.h"
#include "acquisition/recording.h"
#include "acquisition/sequence_fields.h"
#include "acquisition/sequence_file.h"
#include "acquisition/sequence_writer.h"
#include "core/atomic_file.h"
#include "core/error.h"

namespace fathom {

namespace {

constexpr std::size_t kDeflateBytes = 1 << 18;
constexpr std::size_t kHeaderPieceBytes = 1 << 20;
constexpr std::size_t kPixelAlignment = 64;  // any type, and whole cache lines, in a mapped file
constexpr int kZlibHeader = 15;              // zlib's code for: largest window, zlib header
constexpr int kGzipHeader = 15 + 16;         // and with a gzip header

/// Compresses into a file as bytes come.
class Deflater {
 public:
  Deflater(AtomicFile& file, int header) : file_(file), out_(kDeflateBytes) {
    constexpr int kMemoryLevel = 8;  // zlib's default
    if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, header, kMemoryLevel, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  void write(std::span<const std::byte> bytes) { run(bytes, Z_NO_FLUSH); }

  /// Ends the stream; returns its length.
  std::uint64_t finish() {
    run({}, Z_FINISH);
    return written_;
  }

 private:
  void run(std::span<const std::byte> bytes, int flush) {
    // zlib's interface predates const; it does not write to its input.
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    do {
      stream_.next_out = reinterpret_cast<Bytef*>(out_.data());
      stream_.avail_out = static_cast<uInt>(out_.size());
      deflate(&stream_, flush);
      const std::size_t produced = out_.size() - stream_.avail_out;
      file_.write(std::span<const std::byte>(out_).first(produced));
      written_ += produced;
    } while (stream_.avail_out == 0);
  }

  AtomicFile& file_;
  std::vector<std::byte> out_;
  z_stream stream_ = {};
  std::uint64_t written_ = 0;
};

template <typename Sink>
void write_pixels(const Recording& recording, Sink& sink, const Progress& progress) {
  const RecordingHeader& header = recording.header();
  for (int f = 0; f < header.frame_count(); ++f) {
    report(progress, static_cast<double>(f) / header.frame_count());
    const cv::Mat image = recording.image(f);
    if (image.size() != cv::Size(header.width, header.height) || image.type() != header.pixel_type) {
      throw Error(printable(recording.name()) + ": frame " + std::to_string(f) +
                  " has another size or type than the recording; record again");
    }
    for (int row = 0; row < image.rows; ++row) {
      sink.write(std::as_bytes(std::span(image.ptr(row), image.elemSize() * static_cast<std::size_t>(image.cols))));
    }
  }
  report(progress, 1.0);
}

/// Writes the pixels, compressed or not. Returns the number of bytes in the file.
std::uint64_t write_pixels(const Recording& recording, AtomicFile& file, std::optional<int> deflate_header,
                           const Progress& progress) {
  if (!deflate_header) {
    write_pixels(recording, file, progress);
    return frame_bytes(recording.header()) * static_cast<std::uint64_t>(recording.header().frame_count());
  }
  Deflater deflater(file, *deflate_header);
  write_pixels(recording, deflater, progress);
  return deflater.finish();
}

void check_header(const Recording& recording) {
  const RecordingHeader& header = recording.header();
  const std::string name = printable(recording.name());
  if (header.frames.empty()) throw Error(name + ": has no frames; there is nothing to write");
  for (std::size_t f = 0; f < header.frames.size(); ++f) {
    const FrameHeader& frame = header.frames[f];
    const std::string where = name + ": frame " + std::to_string(f);
    if (frame.time_s && !std::isfinite(*frame.time_s)) throw Error(where + ": its time is not finite; record again");
    for (std::size_t t = 0; t < header.transforms.size(); ++t) {
      if (frame.poses[t]) check_pose(*frame.poses[t], header.transforms[t], where);
    }
  }
}

/// Writes all of a header but its last line end, and returns the header's length so far.
std::uint64_t write_header(const RecordingHeader& header, AtomicFile& file, const std::string& preamble,
                           const FieldSyntax& syntax) {
  std::uint64_t written = 0;
  std::string text = preamble;
  const auto flush = [&](std::size_t kept) {
    file.write(std::string_view(text).substr(0, text.size() - kept));
    written += text.size() - kept;
    text.erase(0, text.size() - kept);
  };
  for (std::size_t f = 0; f < header.frames.size(); ++f) {
    append_frame_fields(text, header.transforms, header.frames[f], f, syntax);
    if (text.size() > kHeaderPieceBytes) flush(1);
  }
  text.pop_back();
  flush(0);
  return written;
}

/// Blanks to write so that pixels begin aligned, when `rest` bytes of header are still to come.
std::string padding(std::uint64_t written, std::size_t rest) {
  const std::uint64_t end = written + rest;
  return std::string(static_cast<std::size_t>((kPixelAlignment - end % kPixelAlignment) % kPixelAlignment), ' ');
}

void write_mha(const Recording& recording, const std::filesystem::path& path, const SequenceLayout& sequence_layout,
               const Progress& progress) {
  const bool compress = sequence_layout.compressed;
  const MetaImageLayout layout = {
      .compressed = compress, .pixel_file = "LOCAL", .reference_from_voxel = sequence_layout.reference_from_voxel};
  const std::string preamble = metaimage_preamble(recording.header(), recording.header().frame_count(), layout);
  const std::string closing = '\n' + metaimage_closing_line(layout);
  AtomicFile file(path);
  const std::uint64_t written = write_header(recording.header(), file, preamble, kMetaImageFields);
  // Readers trim values, so blanks behind the last one are free.
  file.write(padding(written, closing.size()));
  file.write(closing);
  if (recording.header().has_images()) {
    const std::uint64_t bytes =
        write_pixels(recording, file, compress ? std::optional(kZlibHeader) : std::nullopt, progress);
    if (compress) file.overwrite(compressed_size_place(preamble), std::to_string(bytes));
  }
  file.commit();
}

void write_mhd(const Recording& recording, const std::filesystem::path& path, const SequenceLayout& sequence_layout,
               const Progress& progress) {
  const bool compress = sequence_layout.compressed;
  const bool has_images = recording.header().has_images();
  std::filesystem::path pixel_path = path;
  pixel_path.replace_extension(compress ? ".zraw" : ".raw");
  const MetaImageLayout layout = {.compressed = compress,
                                  .pixel_file = has_images ? pixel_path.filename().string() : "LOCAL",
                                  .reference_from_voxel = sequence_layout.reference_from_voxel};
  if (const auto fault = has_images ? fault_of_pixel_file_name(layout.pixel_file) : std::nullopt) {
    throw Error(printable(path.string()) + ": its pixels would lie in \"" + printable(layout.pixel_file) +
                "\", which " + *fault + "; choose another name, or .mha");
  }
  std::string preamble = metaimage_preamble(recording.header(), recording.header().frame_count(), layout);
  AtomicFile file(path);
  std::optional<AtomicFile> pixels;
  if (has_images) {
    pixels.emplace(pixel_path);
    const std::uint64_t bytes =
        write_pixels(recording, *pixels, compress ? std::optional(kZlibHeader) : std::nullopt, progress);
    const std::string digits = std::to_string(bytes);
    if (compress) preamble.replace(compressed_size_place(preamble), digits.size(), digits);
  }
  write_header(recording.header(), file, preamble, kMetaImageFields);
  file.write('\n' + metaimage_closing_line(layout));
  if (pixels) {
    AtomicFile::commit_all({&*pixels, &file});
  } else {
    file.commit();
  }
}

void write_nrrd(const Recording& recording, const std::filesystem::path& path, const SequenceLayout& sequence_layout,
                const Progress& progress) {
  const bool compress = sequence_layout.compressed;
  const NrrdLayout layout = {.compressed = compress, .reference_from_voxel = sequence_layout.reference_from_voxel};
  AtomicFile file(path);
  const std::uint64_t written =
      write_header(recording.header(), file, nrrd_preamble(recording.header(), layout), kNrrdFields);
  const std::string comment = "\n#";
  const std::string closing = "\n\n";
  file.write(comment);
  file.write(padding(written, comment.size() + closing.size()));
  file.write(closing);
  if (recording.header().has_images()) {
    write_pixels(recording, file, compress ? std::optional(kGzipHeader) : std::nullopt, progress);
  }
  file.commit();
}

}  // namespace

void write_sequence(const Recording& recording, const std::filesystem::path& path, const SequenceLayout& layout,
                    const Progress& progress) {
  check_header(recording);
  const std::string extension = path.extension().string();
  if (equal_ignoring_case(extension, ".mha")) return write_mha(recording, path, layout, progress);
  if (equal_ignoring_case(extension, ".mhd")) return write_mhd(recording, path, layout, progress);
  if (equal_ignoring_case(extension, ".nrrd")) return write_nrrd(recording, path, layout, progress);
  throw Error(printable(path.string()) + ": a " + (layout.reference_from_voxel ? "volume" : "recording") +
              " cannot be written as \"" + printable(extension) + "\"; name a file ending in .mha, .mhd or .nrrd");
}

void write_recording(const Recording& recording, const std::filesystem::path& path, const WriteOptions& options,
                     const Progress& progress) {
  // Poses alone have no pixels to compress.
  const bool compress = options.compress && recording.header().has_images();
  write_sequence(recording, path, {.compressed = compress, .reference_from_voxel = std::nullopt}, progress);
}

}  // namespace fathom
