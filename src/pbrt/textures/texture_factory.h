#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/images/image.h"
#include "pbrt/math/transform.h"
#include "pbrt/textures/texture.h"
#include "pbrt/textures/texture_params.h"

namespace pbrt {

/// Named textures of a scene, made when first asked for (spectrum textures once per use), and the reader of
/// texture-valued parameters. Definitions are kept; a texture may only use textures defined before it. When the first
/// image map is made, the files of all image maps defined so far are read at once, on all threads.
class TextureLibrary {
  public:
    /// `cacheMegabytes` > 0: big images are kept on disk, and at most this much of them in memory.
    TextureLibrary(const FileResolver &files, DiagnosticSink &sink, int cacheMegabytes = 0);
    ~TextureLibrary();

    /// A Texture directive. Throws UserError on an unknown class; errors in parameters come from CheckAll or first use.
    void Define(const std::string &name, bool isSpectrum, const std::string &textureClass, ParamSet params,
                const Transform &renderFromTexture);
    /// Makes every texture that nothing used, so that their mistakes are reported too, then reports unused parameters
    /// and the number of missing images. Mistakes in a texture go to the sink once, however often it is used; its users
    /// get the constant 0.5 instead.
    void CheckAll();

    /// The texture that a parameter names, or a constant one of the value given or the default; nullptr if there is
    /// neither. Throws UserError.
    FloatTexturePtr Get(const FloatTextureParam &param);
    SpectrumTexturePtr Get(const SpectrumTextureParam &param);

    /// An image file as R, G, B without decoding (normal maps). Each file is read once. Throws UserError (no location).
    std::shared_ptr<const Image> GetLinearRgbImage(const std::string &file);

    /// Number of image textures whose file was not found (already reported to the sink).
    size_t MissingImages() const { return missingImages_; }

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    size_t missingImages_ = 0;
};

/// Texture classes of the pbrt-v4 format that are not supported.
const std::vector<std::string> &UnsupportedTextures();

}  // namespace pbrt
