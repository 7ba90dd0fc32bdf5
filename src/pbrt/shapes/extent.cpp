#include "pbrt/shapes/extent.h"

#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {
namespace {

std::string PointText(const Point3 &p) { return fmt::format("({}, {}, {})", p.x, p.y, p.z); }

const MeshData *MeshOf(const Shape &shape) {
    const auto *mesh = dynamic_cast<const Mesh *>(&shape);
    return mesh ? &mesh->Data() : nullptr;
}

}  // namespace

Bounds3 TransformBounds(const Transform &t, const Bounds3 &b) {
    Bounds3 around;
    if (b.IsEmpty()) return around;
    for (int i = 0; i < 8; ++i) around = Union(around, t.Point(b.Corner(i)));
    return around;
}

Bounds3 BoundsOf(const Shape &shape) {
    Bounds3 all;
    if (const MeshData *mesh = MeshOf(shape)) {
        for (const Point3 &p : mesh->p) all = Union(all, p);
        return all;
    }
    for (uint32_t i = 0; i < shape.PrimitiveCount(); ++i) all = Union(all, shape.PrimitiveBounds(i));
    return all;
}

void RequireReach(const std::string &what, const AnimatedTransform &place, const Bounds3 &b, const FileLoc &loc) {
    if (b.IsEmpty()) return;
    for (const Transform &t : {place.Start(), place.At(place.EndTime())})
        for (int i = 0; i < 8; ++i)
            if (const Point3 p = t.Point(b.Corner(i)); !IsWithinReach(p))
                throw UserError(loc, "{} reaches to {} after the transformation; coordinates must be {}.", what,
                                PointText(p), Text(kCoordinateRange));
}

void RequireReach(const std::string &what, const Shape &shape, const FileLoc &loc) {
    if (const MeshData *mesh = MeshOf(shape)) {
        for (size_t i = 0; i < mesh->p.size(); ++i)
            if (!IsWithinReach(mesh->p[i]))
                throw UserError(loc, "{}: vertex {} lies at {} after the transformation; coordinates must be {}.", what,
                                i, PointText(mesh->p[i]), Text(kCoordinateRange));
        return;
    }
    for (uint32_t i = 0; i < shape.PrimitiveCount(); ++i)
        RequireReach(what, Transform(), shape.PrimitiveBounds(i), loc);
}

}  // namespace pbrt
