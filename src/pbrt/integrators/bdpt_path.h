#pragma once
#include <span>

#include "pbrt/lightsamplers/light_sampler.h"
#include "pbrt/paths/path_walk.h"

namespace pbrt {

/// A place of a bidirectional path: the camera, a light, or a surface.
struct BdptVertex {
    enum class Kind { Camera, Light, Surface };
    Kind kind = Kind::Surface;
    /// Radiance or importance that reaches the vertex along its subpath, divided by the subpath's density.
    SampledSpectrum beta{1};
    /// Density with which its own subpath makes it, and with which a subpath from the other end would: by area; lights
    /// beyond the scene: by solid angle.
    Float pdfForward = 0, pdfReverse = 0;
    /// A surface that scattered the subpath specularly: nothing connects to it.
    bool isSpecular = false;
    PathVertex surface;  ///< Kind::Surface
    // Kind::Light; `p` also of the camera.
    LightId light{};
    Point3 p{};
    Vector3 pError{};
    Normal3 n{};                 ///< zero where there is no surface
    Vector3 direction{0, 0, 1};  ///< of light from beyond the scene
    bool isBeyondScene = false;

    bool IsSurface() const { return kind == Kind::Surface; }
    Point3 Position() const { return IsSurface() ? surface.point.p : p; }
    Normal3 Normal() const { return IsSurface() ? surface.point.n : n; }
    /// Unit, towards another vertex.
    Vector3 Towards(const BdptVertex &to) const {
        if (to.isBeyondScene) return -to.direction;
        return isBeyondScene ? direction : Normalize(to.Position() - Position());
    }
    /// Turns a density by solid angle, of directions from `from` to this vertex, into one by area here.
    Float AreaPdf(const BdptVertex &from, Float solidAnglePdf) const {
        if (isBeyondScene) return solidAnglePdf;
        const Vector3 d = Position() - from.Position();
        const Float l2 = LengthSquared(d);
        if (!(l2 > 0)) return 0;
        const Normal3 normal = Normal();
        return solidAnglePdf / l2 * (normal == Normal3(0) ? Float(1) : AbsDot(normal, d) / std::sqrt(l2));
    }
};

/// What the weights of bidirectional paths need to know.
class BdptWeights {
  public:
    /// `shooting` chose the lights of light subpaths, `connecting` chooses those of single light vertices.
    BdptWeights(const LightTable &lights, const LightSampler &shooting, const LightSampler &connecting)
        : lights_(lights), shooting_(shooting), connecting_(connecting) {}

    /// The weight of the balance heuristic for a path that was made with so many vertices from the light, against all
    /// other numbers with which the same path can be made (Veach 1997, section 10.2). `path`: its vertices from the
    /// light to the camera, each with the densities of its own subpath. `cameraPdf`: the density by area with which the
    /// camera finds the vertex next to it.
    Float Weight(std::span<const BdptVertex *const> path, int fromLight, Float cameraPdf,
                 const SampledWavelengths &lambda) const;

    /// Density of the light's own end of a light subpath: by area; beyond the scene: by solid angle.
    Float LightPdf(const BdptVertex &light, const BdptVertex &next) const;

  private:
    /// Density by area with which a light subpath that begins at `light` goes on to `next`.
    Float FirstStepPdf(const BdptVertex &light, const BdptVertex &next) const;
    /// The same as LightPdf for a light vertex that was chosen for, and seen from, the vertex `from`, which goes on to
    /// `beyond` and is the vertex of this depth from the camera. Of a sky that is chosen by tiles: of the tile.
    Float ConnectedLightPdf(const BdptVertex &light, const BdptVertex &from, const BdptVertex &beyond,
                            const SampledWavelengths &lambda, int depth) const;
    const LightTable &lights_;
    const LightSampler &shooting_, &connecting_;
};

/// What light sampling asks at a surface vertex that a camera path comes to from `beyond`, as its vertex of this depth.
LightQuery BdptQuery(const BdptVertex &vertex, const BdptVertex &beyond, const SampledWavelengths &lambda, int depth);

}  // namespace pbrt
