#pragma once
#include <memory>
#include <string>

#include "pbrt/core/files.h"
#include "pbrt/images/image.h"
#include "pbrt/math/transform.h"
#include "pbrt/spectra/spectrum_params.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// A number or named float texture: its declaration and, after reading, the given value. Valid while the ParamSet
/// lives. If both a number and a name are given, the last one is used, and the other is an unused parameter.
struct FloatTextureParam {
    std::optional<Float> constant{};      ///< default; nullopt: none
    std::optional<Range<Float>> range{};  ///< of numbers and constant textures
    const ParamSet *set = nullptr;
    const Param *given = nullptr;

    explicit operator bool() const { return given != nullptr; }
};

struct SpectrumTextureParam : SpectrumParam {};

void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value);
void ReadParam(ParamReader &reader, const std::string &name, FloatTextureParam &value, const Range<Float> &range);
void ReadParam(ParamReader &reader, const std::string &name, SpectrumTextureParam &value);
void DocumentParam(ParamDoc &doc, const FloatTextureParam &value);
void DocumentParam(ParamDoc &doc, const SpectrumTextureParam &value);

/// Named textures of a scene, created on first use (spectrum textures once per use), and the reader of texture
/// parameters. A texture may only use textures defined before it. With the first image map, the files of all image maps
/// defined so far are read in parallel.
class TextureLibrary {
  public:
    /// `cacheMegabytes` > 0: big images are stored on disk, with at most this much of them in memory.
    TextureLibrary(const FileResolver &files, DiagnosticSink &sink, int cacheMegabytes = 0);
    ~TextureLibrary();

    /// Executes a Texture directive. Throws UserError on an unknown class; others come from CheckAll or use.
    void Define(const std::string &name, bool isSpectrum, const std::string &textureClass, ParamSet params,
                const Transform &renderFromTexture);
    /// Creates all unused textures to find their errors, then reports unused parameters and the number of missing
    /// images. Errors in a texture are reported once; its users get the constant 0.5 instead.
    void CheckAll();

    /// The texture named by a parameter, or a constant of the given or default value; or null. Throws UserError.
    FloatTexturePtr Get(const FloatTextureParam &param);
    SpectrumTexturePtr Get(const SpectrumTextureParam &param);

    /// Undecoded R, G, B of an image file (normal maps), read once per file. Throws UserError (no location).
    std::shared_ptr<const Image> GetLinearRgbImage(const std::string &file);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Texture class of the format that is not supported.
inline constexpr const char *kUnsupportedTexture = "ptex";

}  // namespace pbrt
