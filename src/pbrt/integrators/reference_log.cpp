#include "pbrt/integrators/reference_log.h"

#include <cerrno>
#include <cstring>

#include "pbrt/images/metrics.h"

namespace pbrt {

ReferenceLog::ReferenceLog(const std::string &referenceImage, const std::string &outFile, const Film &film) {
    if (referenceImage.empty()) return;
    ImageFile file = ReadImage(referenceImage);
    const Bounds2i &wanted = film.PixelBounds();
    Bounds2i have = file.metadata.pixelBounds.value_or(Bounds2i{{0, 0}, file.image.Resolution()});
    if (wanted.low.x < have.low.x || wanted.low.y < have.low.y || wanted.high.x > have.high.x ||
        wanted.high.y > have.high.y)
        throw UserError(fmt::format("{}: the reference image covers x {}-{}, y {}-{}; the film needs x {}-{}, y {}-{}.",
                                    referenceImage, have.low.x, have.high.x, have.low.y, have.high.y, wanted.low.x,
                                    wanted.high.x, wanted.low.y, wanted.high.y));
    reference_ = file.image.Select({"R", "G", "B"}).Crop({wanted.low - have.low, wanted.high - have.low});
    name_ = outFile;
    out_.reset(std::fopen(name_.c_str(), "w"));
    if (!out_) throw UserError(fmt::format("{}: cannot be written: {}.", name_, std::strerror(errno)));
}

std::optional<double> ReferenceLog::Log(int samples, const Film &film) {
    if (!reference_) return {};
    Image image = film.ToImage();
    if (image.ChannelCount() > 3) image = image.Select({"R", "G", "B"});
    double mse = ImageError(image, reference_, Metric::MSE);
    // If the log cannot be written, the render continues without it.
    if (out_ && (std::fprintf(out_.get(), "%d, %.9g\n", samples, mse) < 0 || std::fflush(out_.get()) != 0)) {
        Fail();
        out_.reset();
    }
    return mse;
}

const std::string &ReferenceLog::Finish() {
    // Some file systems report failed writes only on close.
    if (out_ && std::fclose(out_.release()) != 0) Fail();
    return failure_;
}

void ReferenceLog::Fail() { failure_ = fmt::format("{}: cannot be written: {}.", name_, std::strerror(errno)); }

}  // namespace pbrt
