#include "pbrt/shapes/solid_angle_sampling.h"

namespace pbrt {

struct TriangleSampling::InDouble {
    glm::dvec3 to[3], distance;
    SphericalTriangleOf<double> sphere;

    explicit InDouble(const View &s) {
        const glm::dvec3 from(s.from);
        const Point3 corners[] = {s.p0, s.p1, s.p2};
        for (int i = 0; i < 3; ++i) {
            to[i] = glm::dvec3(corners[i]) - from;
            distance[i] = glm::length(to[i]);
        }
        sphere = {to[0] / distance[0], to[1] / distance[1], to[2] / distance[2]};
    }
};

double TriangleSampling::AreaInDouble(View view) { return InDouble(view).sphere.Area(); }

TriangleSampling::Point TriangleSampling::SampleInDouble(View view, Point2 square, Float squarePdf) {
    const InDouble triangle(view);
    glm::dvec3 b = triangle.sphere.Sample(square) / triangle.distance;
    b /= b.x + b.y + b.z;
    const glm::dvec3 offset = b.x * triangle.to[0] + b.y * triangle.to[1] + b.z * triangle.to[2];
    return {Vector3(b), squarePdf / Float(triangle.sphere.Area()), Vector3(offset)};
}

Point2 TriangleSampling::InvertInDouble(View view, Vector3 wi, Float *area) {
    const InDouble triangle(view);
    const glm::dvec3 w = glm::normalize(glm::dvec3(wi));
    *area = Float(triangle.sphere.Area());
    return triangle.sphere.Invert(triangle.sphere.WeightsOf(w), w);
}

}  // namespace pbrt
