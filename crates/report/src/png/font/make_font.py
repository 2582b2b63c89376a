"""Makes the fonts of the pictures from DejaVu Sans 2.37: a subset, with every glyph's box begun at the pen.

    pip install fonttools
    python make_font.py DejaVuSans.ttf lumiduct-regular.ttf
    python make_font.py DejaVuSans-Bold.ttf lumiduct-bold.ttf

The drawing library puts the left edge of a glyph's box at the pen and so loses the white space before the glyph.
A contour without area at the origin makes every box begin at the pen, and letters stand where they belong.
"""

import sys

from fontTools import subset
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import TTFont

RANGES = [
    (0x20, 0x7E), (0xA0, 0x17F),  # Latin
    (0x384, 0x3CE), (0x3D1, 0x3D6), (0x2126, 0x2126),  # Greek, ohm
    (0x400, 0x45F),  # Cyrillic
    (0x2009, 0x2015), (0x2018, 0x201E), (0x2020, 0x2022), (0x2026, 0x2026), (0x202F, 0x2033),  # punctuation
    (0x2070, 0x2071), (0x2074, 0x208E),  # superscripts, subscripts
    (0x20AC, 0x20AC), (0x2113, 0x2113), (0x2190, 0x2195),  # euro, litre, arrows
    (0x2202, 0x2202), (0x2205, 0x2207), (0x220F, 0x220F), (0x2211, 0x2215), (0x2219, 0x2220),  # mathematics
    (0x222B, 0x222B), (0x223C, 0x223C), (0x2248, 0x2248), (0x2260, 0x2265), (0x226A, 0x226B),
    (0x22A5, 0x22A5), (0x22C5, 0x22C5), (0x2300, 0x2300), (0x25B2, 0x25B2), (0x25CF, 0x25CF),
]


def main(source, target):
    font = TTFont(source, recalcTimestamp=False)
    options = subset.Options()
    options.hinting = False
    options.layout_features = []
    options.notdef_outline = True
    options.name_IDs = [0, 1, 2, 13, 14]
    options.drop_tables += ["GSUB", "GPOS", "GDEF", "kern", "FFTM"]
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[code for first, last in RANGES for code in range(first, last + 1)])
    subsetter.subset(font)
    begin_boxes_at_the_pen(font)
    for record in font["name"].names:
        if record.nameID == 1:
            record.string = "Lumiduct Sans"
    font.save(target)


def begin_boxes_at_the_pen(font):
    shapes, metrics, glyphs = font["glyf"], font["hmtx"], font.getGlyphSet()
    changed = {}
    for name in font.getGlyphOrder():
        if shapes[name].numberOfContours != 0:
            outline = DecomposingRecordingPen(glyphs)
            glyphs[name].draw(outline)
            pen = TTGlyphPen(None)
            outline.replay(pen)
            pen.moveTo((0, 0))
            pen.lineTo((1, 0))
            pen.lineTo((0, 0))
            pen.closePath()
            changed[name] = pen.glyph(dropImpliedOnCurves=False)
    for name, glyph in changed.items():
        shapes[name] = glyph
        glyph.recalcBounds(shapes)
        metrics[name] = (metrics[name][0], glyph.xMin)


if __name__ == "__main__":
    main(*sys.argv[1:])
