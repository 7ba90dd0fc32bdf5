#pragma once
#include <optional>
#include <string>

#include "pbrt/films/film_frame.h"

namespace pbrt {

/// How a scene is to be rendered, as given on the command line; overrides the scene file.
struct BuildOptions {
    FilmOverrides film;
    int samplesPerPixel = 0;  ///< --spp; 0: the scene's
    std::optional<int> seed;  ///< --seed
    bool quick = false;       ///< a quarter of the resolution, one sample unless samplesPerPixel is set
    bool ignoreMedia = false, ignoreUnsupported = false;  ///< leave out what is not supported, with warnings
    bool checksOutput = false;      ///< the film's file will be written: an error before building if it cannot be
    std::string integrator;         ///< --integrator name; empty: the scene's
    std::optional<int> maxDepth;    ///< --maxdepth
    bool sampledLightOnly = false;  ///< PathSettings::sampledLightOnly (path, volpath)
    bool guide = false;             ///< --guide
    std::string lightSampler;       ///< --lightsampler, see LightFlags; empty: the scene's
    bool meshLights = false;        ///< --mesh-lights
    std::string shootingSampler;    ///< --shooting-sampler name[:key=value,...]; empty: the scene's
    const char *lightSamplerFlag = "--lightsampler";  ///< the name of the flag that gave lightSampler, for messages
    std::optional<Float> displacementEdgeScale;       ///< --displacement-edge-scale; empty: the scene's or 1
    std::string renderCoordSys;                       ///< camera, cameraworld, world; empty: the scene's or cameraworld
    bool disableTextureFiltering = false;
    bool forceDiffuse = false;  ///< --force-diffuse
    int textureCacheMb = 0;     ///< --texture-cache-mb; 0: all images in memory
    bool disablePixelJitter = false, disableWavelengthJitter = false;
    std::string mseReferenceImage, mseReferenceOut;  ///< empty: the scene's Option, if any
};

}  // namespace pbrt
