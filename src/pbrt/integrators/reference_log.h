#pragma once
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string>

#include "pbrt/films/film.h"
#include "pbrt/images/metrics.h"

namespace pbrt {

/// Logs one line "samples, mean squared error" per wave against a reference image.
class ReferenceLog {
  public:
    /// Reads the reference and creates `outFile`; with empty names a log that does nothing. Throws UserError if the
    /// reference does not cover the film or a file cannot be opened.
    static ReferenceLog Open(const std::string &referenceImage, const std::string &outFile, const Film &film) {
        ReferenceLog log;
        if (referenceImage.empty()) return log;
        ImageFile file = ReadImage(referenceImage);
        const Bounds2i &wanted = film.PixelBounds();
        Bounds2i have = file.metadata.pixelBounds.value_or(Bounds2i{{0, 0}, file.image.Resolution()});
        if (wanted.low.x < have.low.x || wanted.low.y < have.low.y || wanted.high.x > have.high.x ||
            wanted.high.y > have.high.y)
            throw UserError("{}: the reference image covers x {}-{}, y {}-{}; the film needs x {}-{}, y {}-{}.",
                            referenceImage, have.low.x, have.high.x, have.low.y, have.high.y, wanted.low.x,
                            wanted.high.x, wanted.low.y, wanted.high.y);
        log.reference_ = file.image.Select({"R", "G", "B"}, referenceImage + ":")
                             .Crop({wanted.low - have.low, wanted.high - have.low});
        log.name_ = outFile;
        log.out_.reset(std::fopen(outFile.c_str(), "w"));
        if (!log.out_) throw UserError("{}: cannot be written: {}.", outFile, std::strerror(errno));
        return log;
    }

    bool IsKept() const { return bool(reference_); }

    /// Writes and returns the mean squared error of the film over R, G and B; empty without a reference.
    std::optional<double> Log(int samples, const Film &film) {
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

    /// Closes the file. Returns why it is incomplete; empty if complete.
    const std::string &Finish() {
        // Some file systems report failed writes only on close.
        if (out_ && std::fclose(out_.release()) != 0) Fail();
        return failure_;
    }

  private:
    ReferenceLog() = default;
    struct Close {
        void operator()(std::FILE *f) const { std::fclose(f); }
    };
    void Fail() { failure_ = fmt::format("{}: cannot be written: {}.", name_, std::strerror(errno)); }

    Image reference_;
    std::string name_, failure_;
    std::unique_ptr<std::FILE, Close> out_;
};

}  // namespace pbrt
