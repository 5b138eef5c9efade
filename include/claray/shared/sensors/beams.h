// Beams, poses and returns of sensors, shared by the host and all kernels.
#ifndef CLARAY_SHARED_SENSORS_BEAMS_H
#define CLARAY_SHARED_SENSORS_BEAMS_H

#include "claray/shared/portable.h"

CLARAY_SHARED_BEGIN

/// A beam in the frame of its sensor: a unit vector, and when it is sent, from 0 to 1 within a scan.
typedef struct SensorBeam {
    float x, y, z;
    float time;
} SensorBeam;
CLARAY_LAYOUT(SensorBeam, 16)

/// A ray of a beam, by its unit vector's components: along the beam, and across it to the left and up. The shares of a
/// beam's power add up to 1.
typedef struct BeamRay {
    float along, left, up;
    float share;
} BeamRay;
CLARAY_LAYOUT(BeamRay, 16)

/// Where a sensor is at the begin and at the end of a scan. Between them its position moves on a straight line, and its
/// rotation, a unit quaternion x, y, z, w, is interpolated linearly and normalised.
typedef struct SensorPose {
    float begin[3], end[3];
    float turn_begin[4], turn_end[4];
} SensorPose;
CLARAY_LAYOUT(SensorPose, 56)

#define CLARAY_STRONGEST_FIRST 0
#define CLARAY_NEAREST_FIRST 1
#define CLARAY_FARTHEST_FIRST 2

/// What a sensor does; the members are those of SensorConfig.
typedef struct SensorSettings {
    uint sensors, beams, columns;
    uint order, in_world;
    uint seed, scan;
    uint fixed_places;
    float nearest, farthest;
    float range_resolution, velocity_resolution;
    float range_noise, intensity_noise, velocity_noise, dropout;
    float reference_range, extinction, least_intensity;
    float duration, per_second;
} SensorSettings;
CLARAY_LAYOUT(SensorSettings, 84)

/// The unit normal and the material of a triangle, in the coordinates of the structure that holds it.
typedef struct SensorTriangle {
    float x, y, z;
    uint material;
} SensorTriangle;
CLARAY_LAYOUT(SensorTriangle, 16)

/// An instance of the scene, and the index of its first triangle in the list of all.
typedef struct SensorPlace {
    uint instance;
    uint first;
} SensorPlace;
CLARAY_LAYOUT(SensorPlace, 8)

/// A return of a beam. Without one, x, y, z, range and velocity are NaN, the intensity, the share and the normal are 0,
/// and instance, primitive and material are CLARAY_MISS.
typedef struct SensorReturn {
    float x, y, z;    // range times the beam's direction, in the frame of the sensor when it sent the beam; or the place
    float intensity;  // see docs/sensors.md
    float range;
    float velocity;   // range per second; positive if surface and sensor depart from each other
    float time;       // of the beam, in seconds since the begin of the scan
    float share;      // of the beam's power that met these surfaces
    float nx, ny, nz;  // unit normal towards the sensor, in the frame of x, y, z
    uint material;
    uint instance;   // of the scene
    uint primitive;  // triangle of its mesh
    uint ring, column;  // of the beam in its pattern
} SensorReturn;
CLARAY_LAYOUT(SensorReturn, 64)

CLARAY_SHARED_END

#endif
