#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/core/params.h"
#include "pbrt/images/image.h"
#include "pbrt/math/transform.h"
#include "pbrt/spectra/spectrum_params.h"
#include "pbrt/textures/texture.h"

namespace pbrt {

/// Named textures of a scene, made when first asked for (spectrum textures once per use), and the reader of
/// texture-valued parameters. Definitions are kept; a texture may only use textures defined before it. When the first
/// image map is made, the files of all image maps defined so far are read at once, on all threads.
class TextureLibrary {
  public:
    /// `cacheMegabytes` > 0: the memory for big images, the rest of which is kept on disk.
    TextureLibrary(const FileResolver &files, DiagnosticSink &sink, int cacheMegabytes = 0);
    ~TextureLibrary();

    /// A Texture directive. Throws UserError on an unknown class; errors in parameters come from CheckAll or first use.
    void Define(const std::string &name, bool isSpectrum, const std::string &textureClass, ParamSet params,
                const Transform &renderFromTexture);
    /// Makes every texture that nothing used, so that their mistakes are reported too, then reports unused parameters
    /// and the number of missing images. Mistakes in a texture go to the sink once, however often it is used; a
    /// stand-in is returned to its users.
    void CheckAll();

    /// `ft` / `st` parameters (pbrt-v4-format §4). The OrNull forms return nullptr if the parameter is absent.
    FloatTexturePtr GetFloat(const ParamSet &params, const std::string &name, Float defaultValue);
    FloatTexturePtr GetFloatOrNull(const ParamSet &params, const std::string &name);
    SpectrumTexturePtr GetSpectrum(const ParamSet &params, const std::string &name, SpectrumPtr defaultValue,
                                   SpectrumUse use);
    SpectrumTexturePtr GetSpectrumOrNull(const ParamSet &params, const std::string &name, SpectrumUse use);

    /// How many textures that look at the filter footprint were given out so far.
    size_t FootprintUses() const { return footprintUses_; }

    /// The image file a string parameter names, as R, G, B without decoding (normal maps); nullptr if absent. Each file
    /// is read once. Throws UserError.
    std::shared_ptr<const Image> GetLinearRgbImage(const ParamSet &params, const std::string &name);

    /// Number of image textures whose file was not found (already reported to the sink).
    size_t MissingImages() const { return missingImages_; }

  private:
    template <class Ptr>
    Ptr GiveOut(Ptr texture) {
        if (texture && texture->UsesFootprint()) ++footprintUses_;
        return texture;
    }
    struct Impl;
    std::unique_ptr<Impl> impl_;
    size_t missingImages_ = 0, footprintUses_ = 0;
};

const std::vector<std::string> &SupportedTextures();
const std::vector<std::string> &UnsupportedTextures();

}  // namespace pbrt
