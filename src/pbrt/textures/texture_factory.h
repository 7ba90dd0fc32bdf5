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

/// Named textures of a scene, created on first use (spectrum textures once per use), and the reader of texture
/// parameters. A texture may only use textures defined before it. With the first image map, the files of all image maps
/// defined so far are read in parallel.
class TextureLibrary {
  public:
    /// `cacheMegabytes` > 0: big images are stored on disk, with at most this much of them in memory.
    TextureLibrary(const FileResolver &files, DiagnosticSink &sink, int cacheMegabytes = 0);
    ~TextureLibrary();

    /// Executes a Texture directive. Throws UserError on an unknown class; parameter errors come from CheckAll or first
    /// use.
    void Define(const std::string &name, bool isSpectrum, const std::string &textureClass, ParamSet params,
                const Transform &renderFromTexture);
    /// Creates all unused textures to find their errors, then reports unused parameters and the number of missing
    /// images. Errors in a texture are reported once; its users get the constant 0.5 instead.
    void CheckAll();

    /// The texture named by a parameter, or a constant of the given or default value; nullptr if there is neither.
    /// Throws UserError.
    FloatTexturePtr Get(const FloatTextureParam &param);
    SpectrumTexturePtr Get(const SpectrumTextureParam &param);

    /// Undecoded R, G, B of an image file (normal maps), read once per file. Throws UserError (no location).
    std::shared_ptr<const Image> GetLinearRgbImage(const std::string &file);

    /// Number of image textures with missing files (already reported to the sink).
    size_t MissingImages() const { return missingImages_; }

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    size_t missingImages_ = 0;
};

const std::vector<std::string> &UnsupportedTextures();

}  // namespace pbrt
