#pragma once
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "pbrt/films/film.h"

namespace pbrt {

/// Logs one line "samples, mean squared error" per wave against a reference image.
class ReferenceLog {
  public:
    /// Does nothing with empty names. Throws UserError if the reference does not cover the film or a file cannot be
    /// opened.
    ReferenceLog(const std::string &referenceImage, const std::string &outFile, const Film &film);
    bool IsKept() const { return static_cast<bool>(reference_); }
    std::optional<double> Log(int samples, const Film &film);
    /// Closes the file. Returns why it is incomplete; empty if complete.
    const std::string &Finish();

  private:
    struct Close {
        void operator()(std::FILE *f) const { std::fclose(f); }
    };
    void Fail();
    Image reference_;
    std::string name_, failure_;
    std::unique_ptr<std::FILE, Close> out_;
};

}  // namespace pbrt
