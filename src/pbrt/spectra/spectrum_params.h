#pragma once
#include "pbrt/core/files.h"
#include "pbrt/core/param_reader.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// Uplifting of an `rgb` parameter (pbrt-v4-format §4).
enum class SpectrumUse { Albedo, Unbounded, Illuminant };

/// Spectrum parameter in any form: rgb, blackbody, spectrum (inline samples, name, file). Holds its declaration and,
/// after reading, the given value; valid only while the ParamSet lives.
struct SpectrumParam {
    SpectrumUse use = SpectrumUse::Albedo;
    std::optional<Float> constant{};  ///< numeric default
    const char *named = nullptr;      ///< named spectrum as default
    bool takesFloat = false;          ///< "float name" is a constant spectrum
    const ParamSet *set = nullptr;
    const Param *given = nullptr;

    explicit operator bool() const { return given != nullptr; }
    /// The given spectrum or the default; null if there is neither. Throws UserError for negative rgb, albedo above 1,
    /// negative illuminant, odd or unsorted samples, unknown name, unreadable file, or too many values.
    SpectrumPtr Make(const FileResolver &files) const;
};
void ReadParam(ParamReader &reader, const std::string &name, SpectrumParam &value);
void DocumentParam(ParamDoc &doc, const SpectrumParam &value);

/// Error of `parameter`, an emission without luminance that is to be in photometric units.
UserError NoLuminanceError(const ParamSet &set, const char *parameter, const Spectrum &emission);

}  // namespace pbrt
