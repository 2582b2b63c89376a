// Total reflections in a rod of triangles with Embree 3 (robust mode, high-quality build, one thread): the other program of chain.rs.
//
// c++ -O3 -march=native benches/embree_chain.cpp -lembree3 -o embree_chain
// embree_chain ROD.obj PATHS prints the number of segments and the seconds of CPU time.

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <vector>

constexpr double kPi = 3.14159265358979323846;
constexpr double kIndex = 1.49, kSourceRadius = 0.5, kGap = 0.2, kRadius = 1.5;
// A start this far inside, mm: in f32 it could otherwise lie outside the rod.
constexpr float kInside = 1e-4f;

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  std::vector<float> vertices;
  std::vector<unsigned> triangles;
  std::vector<bool> is_end;
  FILE* file = std::fopen(argv[1], "r");
  if (file == nullptr) return 2;
  bool end = false;
  char line[256], name[64];
  while (std::fgets(line, sizeof line, file) != nullptr) {
    float x, y, z;
    unsigned a, b, c;
    if (std::sscanf(line, "v %f %f %f", &x, &y, &z) == 3) {
      vertices.insert(vertices.end(), {x, y, z});
    } else if (std::sscanf(line, "usemtl %63s", name) == 1) {
      end = name[0] != 'w';
    } else if (std::sscanf(line, "f %u %u %u", &a, &b, &c) == 3) {
      triangles.insert(triangles.end(), {a - 1, b - 1, c - 1});
      is_end.push_back(end);
    }
  }
  std::fclose(file);

  RTCDevice device = rtcNewDevice("threads=1");
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  RTCGeometry rod = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  std::copy(vertices.begin(), vertices.end(),
            static_cast<float*>(rtcSetNewGeometryBuffer(rod, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                                        vertices.size() / 3)));
  std::copy(triangles.begin(), triangles.end(),
            static_cast<unsigned*>(rtcSetNewGeometryBuffer(rod, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                                           triangles.size() / 3)));
  rtcCommitGeometry(rod);
  rtcAttachGeometry(scene, rod);
  rtcCommitScene(scene);

  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const long paths = std::atol(argv[2]);
  long segments = 0;
  const std::clock_t start = std::clock();
  for (long path = 0; path < paths; ++path) {
    const double radius = kSourceRadius * std::sqrt(uniform(random)), turn = 2 * kPi * uniform(random);
    const double sine = std::sqrt(uniform(random)), azimuth = 2 * kPi * uniform(random);
    const double way = kGap * sine / std::sqrt(1 - sine * sine);
    const double x = radius * std::cos(turn) + way * std::cos(azimuth);
    const double y = radius * std::sin(turn) + way * std::sin(azimuth);
    if (std::hypot(x, y) >= 0.99 * kRadius) continue;
    const double dx = sine / kIndex * std::cos(azimuth), dy = sine / kIndex * std::sin(azimuth);
    RTCRayHit found;
    RTCRay& ray = found.ray;
    ray.org_x = float(x), ray.org_y = float(y), ray.org_z = 1e-5f;
    ray.dir_x = float(dx), ray.dir_y = float(dy), ray.dir_z = float(std::sqrt(1 - dx * dx - dy * dy));
    // Light that rounding has let out finds nothing.
    for (;;) {
      ray.tnear = 0, ray.tfar = 1e30f, ray.time = 0, ray.mask = ~0u, ray.id = 0, ray.flags = 0;
      found.hit.geomID = RTC_INVALID_GEOMETRY_ID, found.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcIntersect1(scene, &context, &found);
      if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
      ++segments;
      if (is_end[found.hit.primID]) break;
      float nx = found.hit.Ng_x, ny = found.hit.Ng_y, nz = found.hit.Ng_z;
      const float scale = 1 / std::sqrt(nx * nx + ny * ny + nz * nz);
      nx *= scale, ny *= scale, nz *= scale;
      const float along = ray.dir_x * nx + ray.dir_y * ny + ray.dir_z * nz, back = along > 0 ? -kInside : kInside;
      ray.org_x += ray.tfar * ray.dir_x + back * nx;
      ray.org_y += ray.tfar * ray.dir_y + back * ny;
      ray.org_z += ray.tfar * ray.dir_z + back * nz;
      ray.dir_x -= 2 * along * nx, ray.dir_y -= 2 * along * ny, ray.dir_z -= 2 * along * nz;
      const float unit =
          1 / std::sqrt(ray.dir_x * ray.dir_x + ray.dir_y * ray.dir_y + ray.dir_z * ray.dir_z);
      ray.dir_x *= unit, ray.dir_y *= unit, ray.dir_z *= unit;
    }
  }
  std::printf("%ld %.6f\n", segments, double(std::clock() - start) / CLOCKS_PER_SEC);
}
