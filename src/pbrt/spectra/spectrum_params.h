#pragma once
#include "pbrt/core/files.h"
#include "pbrt/core/param_reader.h"
#include "pbrt/spectra/color_space.h"

namespace pbrt {

/// How an `rgb` parameter is uplifted (pbrt-v4-format §4).
enum class SpectrumUse { Albedo, Unbounded, Illuminant };

/// A parameter that is a spectrum in any of its forms: rgb, blackbody, spectrum (inline samples, name, file). Holds
/// the declaration of the parameter and, after reading, what was given; valid only while the ParamSet lives.
struct SpectrumParam {
    SpectrumUse use = SpectrumUse::Albedo;
    std::optional<Float> constant{};  ///< the default, if it is a number
    const char *named = nullptr;      ///< the default, if it is a built-in spectrum
    bool takesFloat = false;          ///< "float name" is a constant spectrum
    const ParamSet *set = nullptr;
    const Param *given = nullptr;

    explicit operator bool() const { return given != nullptr; }
    /// The spectrum given or the default; null if there is neither. Throws UserError for: negative rgb, albedo above 1,
    /// negative illuminant, odd or unsorted samples, unknown name or unreadable file, several values where one is
    /// meant.
    SpectrumPtr Make(const FileResolver &files) const;
};
void ReadParam(ParamReader &reader, const std::string &name, SpectrumParam &value);
void DocumentParam(ParamDoc &doc, const SpectrumParam &value);

}  // namespace pbrt
