#pragma once
/// Antenna patterns in files: tables over the sphere (CSV), and two cuts (MSI Planet, NSMA WG16.99.050).
#include <filesystem>

#include "dcem/em/antenna/pattern_table.hpp"

namespace dcem::io {

/// Reads a table with the columns `azimuth_deg`, `zenith_deg`, `gain_dbi`, found by name, one line per direction in any
/// order; azimuth from local +x towards local +y, zenith from local +z. The azimuths are even steps from 0 around the
/// whole turn (−10 is 350; a last azimuth one turn after the first is allowed where it repeats its gains), the zeniths
/// even steps from 0 to 180. Throws InputError where an angle is missing or there twice, naming it.
PatternTable read_pattern_csv(const std::filesystem::path& file);

/// Writes what `read_pattern_csv` reads, with the fewest digits that read back as the same numbers. Throws OutputError.
void write_pattern_csv(const PatternTable& table, const std::filesystem::path& file);

/// Reads the two cuts of an MSI (Planet) or NSMA WG16.99.050 file, which it tells by its content, and makes a table of
/// them. Throws InputError.
///
/// MSI, after the description of Radio Mobile and what programs write: a line per keyword. `GAIN` is a number in dBd,
/// or in the unit behind it, dBd or dBi (0 dBd = 2.15 dBi). `HORIZONTAL n` and `VERTICAL n` are each followed by n
/// lines of an angle in degrees and an attenuation in dB, counted from the gain, without sign. All other keywords
/// (NAME, MAKE, FREQUENCY, H_WIDTH, V_WIDTH, FRONT_TO_BACK, TILT, POLARIZATION, COMMENT, a maker's own) say nothing
/// about gains and are passed over; a tilt is in the cuts. Horizontal angles are counted clockwise seen from above (0
/// is the boresight), vertical ones downwards (0 horizon, 90 nadir, 180 horizon behind, 270 zenith).
///
/// NSMA: lines `FIELD:,value`. Read are `GUNITS` (gain DBI or DBD, pattern DBR, DBI or DBD), `MDGAIN`, `NOFREQ` (1),
/// `PATCUT` (AZ or H, EL or V), `POLARI`, `NUPOIN` and the points `angle,value[,phase]`. Of several polarizations the
/// first is taken that has both cuts and names the same for antenna and source (V/V); crossed ones are not read.
/// Azimuths run as in MSI, elevations upwards. Not read: patterns at several frequencies, cuts at other angles, LIN.
///
/// Of both: a cut may have its points where it likes, with gaps of at most 90°, linear in dB between them.
///
/// The gain between the cuts, with the attenuations A_H(φ) and A_V(e), elevation e, and w = |φ|/π:
///   A = (1 − w)·A_V(e) + w·A_V(π − e) + cos e·(A_H(φ) − (1 − w)·A_H(0) − w·A_H(π))
/// That is the horizontal projection interpolation of WinProp (Altair, user guide of AMan), in which the front and the
/// back of the vertical cut are weighted by azimuth, with the factor cos e on what the horizontal cut adds: without it
/// the poles would have many gains. It is exact on the vertical cut, and on the horizontal one where the two agree at 0
/// and 180 degrees. Where they do not, the horizontal cut was taken at the tilt, and holds there. A is never less than
/// the least attenuation of the two cuts.
/// The table has steps of 1°, or of 0.5, 0.25 or 0.1° where the points of a cut ask for it.
PatternTable read_msi(const std::filesystem::path& file);

}  // namespace dcem::io
