// A V4L2 camera: opened for each picture, so that others may use it between.
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "common/service/service.hpp"
#include "services/sensor-bus/readers/camera/jpeg.hpp"
#include "services/sensor-bus/readers/registry.hpp"

namespace trb::sensor {
namespace {

constexpr std::size_t kMaxPicture = 1'000'000;  // of SensorImage
constexpr std::size_t kMaxRaw = 32'000'000;
constexpr std::uint32_t kBuffers = 2;
constexpr std::uint32_t kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr int kFrames = 30;  // so many may be faulty before the first good one

int call(int fd, unsigned long what, void* argument) {
  int done = 0;
  do {
    done = ::ioctl(fd, what, argument);
  } while (done < 0 && errno == EINTR);
  return done;
}

class Camera {
 public:
  explicit Camera(ReaderContext& context) : context_(context), devnode_(context.device().devnode) {}

  ~Camera() {
    if (streaming_) {
      std::uint32_t type = kCapture;
      call(file_.get(), VIDIOC_STREAMOFF, &type);
    }
    for (const Mapped& each : buffers_) ::munmap(each.bytes, each.size);
  }
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  Result<Bytes> picture() {
    file_ = Descriptor(::open(devnode_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    if (!file_) return system_error(devnode_, errno);
    v4l2_capability can{};
    if (call(file_.get(), VIDIOC_QUERYCAP, &can) != 0) return system_error(devnode_ + " is no camera", errno);
    const std::uint32_t caps = (can.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? can.device_caps : can.capabilities;
    if ((caps & V4L2_CAP_VIDEO_CAPTURE) == 0) return fail(Errc::bad_value, devnode_ + " takes no pictures", "");
    if (Status set = choose_format(); !set) return set.error();
    if ((caps & V4L2_CAP_STREAMING) == 0) return by_read();
    if (Status mapped = start(); !mapped) return mapped.error();
    return by_buffers();
  }

 private:
  struct Mapped {
    void* bytes = nullptr;
    std::size_t size = 0;
  };

  /// As JPEG if it can.
  Status choose_format() {
    for (const std::uint32_t format :
         {V4L2_PIX_FMT_MJPEG, V4L2_PIX_FMT_JPEG, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_RGB24, V4L2_PIX_FMT_GREY}) {
      v4l2_format wanted{};
      wanted.type = kCapture;
      wanted.fmt.pix.width = context_.rule().width;
      wanted.fmt.pix.height = context_.rule().height;
      wanted.fmt.pix.pixelformat = format;
      if (call(file_.get(), VIDIOC_S_FMT, &wanted) != 0) {
        if (errno == EBUSY) return fail(Errc::busy, devnode_ + " is used by another program", "end that one");
        continue;
      }
      format_ = wanted.fmt.pix;
      if (format_.pixelformat == format) return Done{};
    }
    return fail(Errc::bad_value, devnode_ + " tells pictures neither as JPEG nor as YUYV, RGB24 or GREY",
                "use a camera that does");
  }

  [[nodiscard]] bool gives_jpeg() const {
    return format_.pixelformat == V4L2_PIX_FMT_MJPEG || format_.pixelformat == V4L2_PIX_FMT_JPEG;
  }

  Status start() {
    v4l2_requestbuffers wanted{};
    wanted.count = kBuffers;
    wanted.type = kCapture;
    wanted.memory = V4L2_MEMORY_MMAP;
    if (call(file_.get(), VIDIOC_REQBUFS, &wanted) != 0) return system_error(devnode_, errno);
    for (std::uint32_t i = 0; i < wanted.count; ++i) {
      v4l2_buffer buffer = numbered(i);
      if (call(file_.get(), VIDIOC_QUERYBUF, &buffer) != 0) return system_error(devnode_, errno);
      void* bytes = ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), buffer.m.offset);
      if (bytes == MAP_FAILED) return system_error(devnode_, errno);
      buffers_.push_back({bytes, buffer.length});
      if (call(file_.get(), VIDIOC_QBUF, &buffer) != 0) return system_error(devnode_, errno);
    }
    std::uint32_t type = kCapture;
    if (call(file_.get(), VIDIOC_STREAMON, &type) != 0) return system_error(devnode_, errno);
    streaming_ = true;
    return Done{};
  }

  static v4l2_buffer numbered(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.index = index;
    buffer.type = kCapture;
    buffer.memory = V4L2_MEMORY_MMAP;
    return buffer;
  }

  /// True once there is a frame.
  Status await() {
    const MonotonicTime deadline = now().mono + seconds(context_.rule().timeout_s / 2);
    for (;;) {
      const auto woken = context_.wait(file_.get(), deadline);
      if (woken == ReaderContext::Woken::ready) return Done{};
      if (woken == ReaderContext::Woken::stopped) return fail(Errc::io_error, "it was unplugged", "");
      if (woken == ReaderContext::Woken::late)
        return fail(Errc::timeout, devnode_ + " takes no picture", "plug it in again");
    }
  }

  Result<Bytes> checked(const void* bytes, std::size_t size) const {
    if (!gives_jpeg()) return encoded({static_cast<const char*>(bytes), size});
    if (size > kMaxPicture) {
      return fail(Errc::too_large, "a picture of " + std::to_string(size) + " bytes",
                  "make \"width\" and \"height\" of its rule smaller");
    }
    Bytes out(static_cast<const char*>(bytes), size);
    if (!out.starts_with("\xff\xd8")) return fail(Errc::malformed, devnode_ + " told no JPEG", "plug it in again");
    return out;
  }

  [[nodiscard]] Result<Bytes> encoded(BytesView bytes) const {
    RawPicture raw;
    raw.format = format_.pixelformat == V4L2_PIX_FMT_YUYV    ? PixelFormat::yuyv
                 : format_.pixelformat == V4L2_PIX_FMT_RGB24 ? PixelFormat::rgb24
                                                             : PixelFormat::grey;
    raw.width = format_.width;
    raw.height = format_.height;
    raw.bytes_per_line = format_.bytesperline;
    const bool told = format_.priv == V4L2_PIX_FMT_PRIV_MAGIC && format_.quantization != V4L2_QUANTIZATION_DEFAULT;
    raw.limited =
        told ? format_.quantization == V4L2_QUANTIZATION_LIM_RANGE : format_.colorspace != V4L2_COLORSPACE_JPEG;
    raw.bytes = bytes;
    return to_jpeg(raw, kMaxPicture);
  }

  Result<Bytes> by_buffers() {
    Result<Bytes> out = fail(Errc::malformed, devnode_ + " tells faulty pictures", "plug it in again");
    for (int i = 0; i < kFrames && !out; ++i) {
      if (Status there = await(); !there) return there.error();
      v4l2_buffer buffer = numbered(0);
      if (call(file_.get(), VIDIOC_DQBUF, &buffer) != 0) {
        if (errno == EAGAIN) continue;
        return system_error(devnode_, errno);
      }
      const bool good = (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && buffer.index < buffers_.size() &&
                        buffer.bytesused > 0 && buffer.bytesused <= buffers_[buffer.index].size;
      if (good) out = checked(buffers_[buffer.index].bytes, buffer.bytesused);
      if (!out && out.error().code != Errc::malformed) break;  // the next one would be no better
      if (!out) call(file_.get(), VIDIOC_QBUF, &buffer);
    }
    return out;
  }

  Result<Bytes> by_read() {
    if (Status there = await(); !there) return there.error();
    Bytes bytes(gives_jpeg() ? kMaxPicture + 1 : std::min<std::size_t>(format_.sizeimage, kMaxRaw), '\0');
    const ssize_t size = ::read(file_.get(), bytes.data(), bytes.size());
    if (size < 0) return system_error(devnode_, errno);
    return checked(bytes.data(), static_cast<std::size_t>(size));
  }

  ReaderContext& context_;
  std::string devnode_;
  Descriptor file_;
  v4l2_pix_format format_{};
  std::vector<Mapped> buffers_;
  bool streaming_ = false;
};

}  // namespace

void run_camera(ReaderContext& context) {
  for (;;) {
    while (context.take_asked().empty()) {
      if (context.wait(-1, std::nullopt) == ReaderContext::Woken::stopped) return;
    }
    if (context.stopped()) return;
    Picture picture;
    {
      const ReaderContext::Busy busy(context);
      auto bytes = Camera(context).picture();
      if (bytes) {
        picture.media_type = "image/jpeg";
        picture.bytes = std::move(*bytes);
      } else {
        picture.error = bytes.error();
      }
    }
    context.show(std::move(picture));
  }
}

}  // namespace trb::sensor
