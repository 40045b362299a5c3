"""Tables with a fault or a notice: the command and the page must have the same words for them.

Each case is a table as text, and the error or a notice that it must have, without the name of the file.
"""

from typing import NamedTuple

import pytest

from simcore.grains.form_columns import NEEDED
from simcore.grains.sieve_columns import NEEDED as SIEVE_NEEDED


def assert_words(case, notices_of, file):
    """Check a Case. notices_of(text): notices on a table that is read from the file with this name."""
    if case.error:
        with pytest.raises(ValueError) as error:
            notices_of(case.text)
        assert str(error.value).partition(file)[2].lstrip(",: ") == case.error
    else:
        assert case.notice and any(case.notice in notice for notice in notices_of(case.text))


class Case(NamedTuple):
    """A table, and the end of its error or of one of its notices."""

    text: str
    error: str = ""
    notice: str = ""


COUNTS = (
    "a sieve curve needs masses, such as `mass [g]`. Counts on a grid on the surface (Wolman) may be named `retained`"
)
NO_PAN = "; if the row has what passes the finest sieve, name it `pan`; if it is no sieve, remove the row"
GROSS = "has the mass of the sieve in it; give the mass of the grains, which is the difference, in a column `mass [g]`"
LOWER = (
    "but the sieve is needed that retains a class; give that sieve, such as `opening [mm]`, or both bounds as "
    "`from [mm]` and `to [mm]`; if the table has them, remove this column"
)
SIEVES = [
    Case(
        "Korngröße bis [mm];Masse [g]\n63;8\n31,5;400\n16;700\n8;500\n",
        error=f"the column Korngröße bis [mm] seems to have the upper sizes of classes, {LOWER}",
    ),
    Case(
        "d < [mm],cumulative retained [%]\n16,0\n8,40\n4,100\n",
        error=f"the column d < [mm] seems to have the upper sizes of classes, {LOWER}",
    ),
    Case(
        "mean size [mm],mass [g]\n12,0\n6,40\n3,60\n",
        error=f"the column mean size [mm] seems to have the mean sizes of classes, {LOWER}",
    ),
    Case(
        "Maximum grain size [mm],passing [%],retained [%]\n16,100,0\n8,60,40\n4,0,60\n",
        notice="the columns passing [%] and retained [%] agree; passing [%] is used",
    ),
    *[
        Case(
            f"sieve [mm],mass [g]\n16,0\n8,100\n0.063,200\n{pan},50\nsum,350\n",
            notice="row 6 (sum) is no sieve and is left out",
        )
        for pan in ("<0.063 pan", "< 0.06", "<= 0.063", "< 63 µm", "< 63 µm silt")
    ],
    Case(
        "phi,mass [g]\n-4,0\n-3,20\n-1,40\n4,30\n>4,10\n",
        error="row 6: phi is '>4'; a larger phi is a finer size: name the row `pan` if it has what passes the "
        "finest sieve",
    ),
    Case(
        "sieve [mm],mass [g]\n16,0\n8,12.345\n4,7.812\n2,3\npan,1.204\ntotal,24.361\n",
        notice="row 7 (total) is no sieve and is left out",
    ),
    Case("d < [mm];passing [%];remark\n16;100;\n8;40;\n4;0;\n", notice="columns that are not used: remark"),
    Case(
        'sieve [mm],mass [g]\n64,0\n32,"1,250"\n16,"2,310"\n4,85\npan,10\n',
        error="row 3: mass [g] is '1,250'; if it is 1250, write it so, without a separator of thousands; if not, write "
        "another number of decimals, such as 1,2500",
    ),
    Case(
        "sieve [mm],mass [g]\n16,0\n8,100\n4,200\n<2,50\n",
        error="row 5: sieve [mm] is '<2', but the finest sieve is 4 mm; add the sieve of 2 mm, or write `pan` if the "
        "row has all that passes the finest sieve",
    ),
    Case(
        "sieve [mm],mass [g]\n< 63 µm,50\n4,200\n8,100\n16,0\n",
        error="row 2: sieve [mm] is '< 63 µm', but the finest sieve is 4 mm; add the sieve of 0.063 mm, or write `pan` "
        "if the row has all that passes the finest sieve",
    ),
    Case(
        "sieve [mm],mass [g]\n16,0\n8,100\n4.76,200\n< 4.75 mm,50\nsum,350\n",
        notice="row 6 (sum) is no sieve and is left out",
    ),
    Case(
        "phi,mass [g]\n5,0\n4,300\n3,500\n2,200\n",
        notice="all sieves are finer than 1 mm, because phi is positive; for gravel phi is negative: if its sign was "
        "left out, name the column `psi`",
    ),
    Case(
        "psi,mass [g]\n-5,0\n-4,300\n-3,500\n-2,200\n",
        notice="all sieves are finer than 1 mm, because psi is negative; for gravel psi is positive: if its sign was "
        "left out, name the column `phi`",
    ),
    Case("sieve [mm],retained [%]\n16,0\n8,50\n4,39.5\npan,10\n", notice="retained [%] sums to 99.5 instead of 100"),
    Case("sieve [mm],retained [%]\n16,0\n8,50\n4,40.5\npan,10\n", notice="retained [%] sums to 100.5 instead of 100"),
    Case(
        "sieve [mm],mass [g]\n>63,5\n31.5,30\n16,20\n<16,10\n",
        error="row 2: sieve [mm] is '>63'; write 63: the row of a sieve has what stays on it",
    ),
    Case(
        "sieve [in],mass [g]\n1 1/2,0\n1,30\n0.5,20\n",
        error="row 2: sieve [in] is '1 1/2'; write a fraction as a decimal number, 1.5",
    ),
    Case(
        "sieve [in],mass [g]\n1-1/2,0\n1½,30\n¾,20\n",
        error="row 2: sieve [in] is '1-1/2'; write a fraction as a decimal number, 1.5; rows 3, 4 have errors too",
    ),
    Case(
        "sieve [in],mass [g]\n2,0\n1½,30\n1,20\n",
        error="row 3: sieve [in] is '1½'; write a fraction as a decimal number, 1.5",
    ),
    Case('sieve;mass [g]\n3";0\n1.5″;30\n0.75″;20\n', notice="nothing is taken to pass 19.05 mm"),
    Case(
        "Sieve size (mm)  Mass retained (g)\n16 0\n8 30\n4 20\n",
        error="the columns Sieve and size are both sieve openings; remove one; blanks separate the columns, also "
        "inside their names: separate the columns with semicolons or tabs",
    ),
    Case(
        "Sieve size [mm],Sieve mass [g],Sieve + soil [g]\n16,350,350\n8,430,730\n4,420,580\n",
        error=f"the column Sieve + soil [g] {GROSS}",
    ),
    Case("Sieb [mm];Sieb leer [g];Sieb voll [g]\n16;350;350\n8;430;730\n", error=f"the column Sieb leer [g] {GROSS}"),
    Case(
        "Sieve size [mm],Sieve weight [g],Sieve and soil [g],Soil mass [g]\n16,350,350,0\n8,430,730,300\n"
        "4,420,580,160\n",
        notice="columns that are not used: Sieve weight [g], Sieve and soil [g]",
    ),
    Case(
        "bar;opening [mm];mass [g]\n1;16;0\n1;8;30\n1;4;20\n2;16;0\n2;8;10\n2;4;60\n",
        error="row 5: the opening 16 mm follows 4 mm; a table has one sieve curve, so that each sample needs its own "
        "file",
    ),
    Case(
        "sample;opening [mm];mass [g]\n1;16;0\n1;8;30\n1;4;20\n2;16;0\n2;8;10\n2;4;60\n",
        error="the column sample has several samples (1, 2); a table has one sieve curve, so that each sample needs "
        "its own file",
    ),
    Case("# km 650, left bank\nopening [mm],mass [g]\n8,0\n4,30\n2,10\n", notice="there is no row `pan`"),
    Case(
        "Sieve curve, Rhine km 650\nopening [mm],mass [g]\n8,0\n4,30\n2,10\n",
        error=f"none of the columns (Sieve curve, Rhine km 650) has amounts; {SIEVE_NEEDED}; row 2 has no numbers; if "
        "row 1 is a title above the columns, remove it",
    ),
    Case(
        "lower size [mm],upper size [mm],percent\n8,16,60\n4,8,30\n",
        error="percent sums to 90, not to 100; add what is "
        "missing, such as a row `pan`, or correct the values; cumulative values need a name such as `passing [%]` or "
        "`cumulative retained [%]`",
    ),
    Case(
        "opening [mm],retained [%]\n8,0\n4,61\n2,40\n",
        error="retained [%] sums to 101, not to 100; correct the "
        "values; cumulative values need a name such as `passing [%]` or `cumulative retained [%]`",
    ),
    Case("opening [mm],mass [g]\n8 mm,0\n2 mm,30\n500 µm,10\n", notice="nothing is taken to pass 0.5 mm"),
    Case(
        "opening [mm],mass [g]\n+8,0\n+4,30\n-4,10\n",
        error="row 4: the opening opening [mm] = -4 mm is negative; write [phi] if it is in phi, or `pan` if the row "
        "has what passes 4 mm",
    ),
    Case("psi,mass [g]\n4,0\n3,30\n2,10\n", notice="nothing is taken to pass 4 mm"),
    Case(
        "size [psi];mass [g]\n4;0\n3;30\n25;10\n",
        error="row 4: size [psi] = 25 psi is no sieve; psi is log2 of the opening in mm",
    ),
    Case(
        "Sieve (mm),Mass of sieve + sample (g)\n16,450\n8,800\n4,700\npan,410\n",
        error=f"the column Mass of sieve + sample (g) {GROSS}",
    ),
    Case("Sieb [mm];Masse brutto [g]\n16;450\n8;800\n", error=f"the column Masse brutto [g] {GROSS}"),
    Case(
        "Sieve (mm),Mass of sieve (g),Mass of sieve and soil (g),Retained (g)\n16,450,450,0\n8,400,800,400\n"
        "4,390,700,310\npan,400,410,10\n",
        notice="columns that are not used: Mass of sieve (g), Mass of sieve and soil (g)",
    ),
    Case(
        "Probe;Siebweite [mm];Masse [g]\nA;16;0\nA;8;400\nB;4;300\nB;2;10\n",
        error="the column Probe has several samples (A, B); a table has one sieve curve, so that each sample needs its "
        "own file",
    ),
    Case(
        "opening [mm],passing [%]\n16,100\n8,0.836\n4,0.464\n2,0.1\n",
        error="passing [%] has one value above 1, 100, and the others look like fractions; write percent, such as 85 "
        "instead of 0.85",
    ),
    Case(
        "opening [mm],mass [g]\n16,0\n8,400\n4,300\nfine part,10\n",
        error=f"row 5: opening [mm] is 'fine part', which is no size{NO_PAN}",
    ),
    Case("opening [mm],mass [g]\n16,0\n8,400\n4,300\n,10\n", error=f"row 5: opening [mm] is empty{NO_PAN}"),
    Case(
        "Sieb [mm];Masse [g]\n16;0\n8;400\n4;300\nAuffangschale;10\nSiebverlust;3\n",
        notice="row 6 (Siebverlust) is no sieve and is left out",
    ),
    Case(
        "Sieb [mm];Masse [g]\n16;0\n8;400\n4;300\nSiebboden;10\nEinwaage;800\n",
        notice="row 6 (Einwaage): Masse [g] is 800, but the other rows sum to 710",
    ),
    Case("Tamis (mm);Passants cumulés (%);b\n16;100;\n8;60;\n4;20;\n2;0;\n", notice="columns that are not used: b"),
    Case(
        "opening [mm],count,passing [%]\n16,0,100\n8,40,60\n4,50,10\n2,10,0\n",
        notice="the column count has counts of grains; passing [%] must be shares of the mass, or of counts on a grid "
        "(Wolman), not of the number of all grains",
    ),
    Case(
        "opening [mm],passing [g]\n16,950\n8,400\n4,50\npan,0\ntotal,1000\n",
        notice="passing [g]: all grains are taken to pass the coarsest sieve",
    ),
    Case(
        "opening [mm],passing [%]\n16,99.6\n8,80\n4,40\n2,10\n",
        notice="passing [%]: 99.6 % pass the coarsest sieve instead of 100 %; the shares are divided by it",
    ),
    Case(
        "opening [mm];mass [g]\n16;0\n8;410,5\n4;300\npan;10\nSumme;900\n",
        notice="row 6 (Summe): mass [g] is 900, but the other rows sum to 720.5; if a sieve or class is missing, "
        "add it, or else correct the row that is wrong",
    ),
    Case(
        "opening [mm],mass [g]\n16,0\n8,x\n4,-3\n2,\npan,-1\n",
        error="row 3: mass [g] is 'x'; a number is needed; enter it, or remove the row; rows 4, 5, 6 have errors too",
    ),
    Case(
        "opening [mm],mass [g]\n16,0\nno 10,10\n1,30\n-0.5,5\npan,1\n",
        error="row 3: opening [mm] is 'no 10', a number of a sieve; give its opening instead, in mm; row 5 has an "
        "error too",
    ),
    Case(
        "opening,mass [g]\n16 mm,0\n8,10\n4 mm,30\n2,5\npan,1\n",
        error="row 3: opening is '8', without a unit; write it as in the other rows, or for all rows in the header, "
        "such as `opening [mm]`; row 5 has an error too",
    ),
    Case(
        "min [mm],max [mm],mass [g]\n16,8,100\n8,4,300\n",
        error="row 2: min and max [mm] is '16-8'; give the smaller size first",
    ),
    Case(
        "von [µm];bis [µm];Masse [g]\n500;1.000;100\n1.000;2.000;300\n",
        error="row 3: von [µm] is '1.000'; if it is 1000, write it so, without a separator of thousands; if not, write "
        "another number of decimals, such as 1.0000",
    ),
    Case(
        "opening [mm];mass [g]\n16;0\n11,2;1.410\n8;1.930\n4;300\npan;10\n",
        error="row 3: mass [g] is '1.410', but this table writes decimals with a comma (11,2); write numbers without "
        "separators of thousands",
    ),
    Case(
        'opening,mass [g]\n16 mm,0\n11.2 mm,"1,410"\n8 mm,"1,930"\n4 mm,300\npan,10\n',
        error="row 3: mass [g] is '1,410', but this table writes decimals with a point (11.2); write numbers without "
        "separators of thousands",
    ),
    Case(
        "opening [mm];retained [%];note\n16;0;2,5\n8;50,5 %;wet\n4;49.500 %;\npan;0;\n",
        error="row 4: retained [%] is '49.500 %', but this table writes decimals with a comma (50,5); write numbers "
        "without separators of thousands",
    ),
    *[
        Case(
            f"opening [mm],mass [g]\n{rows}",
            error="row 3: the opening 4 mm follows 4 mm; order the sieves from coarse to fine or from fine to coarse, "
            "each once",
        )
        for rows in ("4,10\n4,20\n", "4,10\n4,20\npan,5\n", "4,10\n4,20\n4,30\n")
    ],
    # φ in a header is the sign of a diameter if the labels have a unit of length.
    Case(
        "Klasse φ;Masse [g];Notiz\n8-16 mm;10;\n4-8 mm;200;\n< 4 mm;100;x\n", notice="columns that are not used: Notiz"
    ),
    Case(
        "opening [mm],mass [g]\n16,0\n11.2,410\n8,930\n5.6,760\n",
        notice="there is no row `pan`: nothing is taken to pass 5.6 mm; if finer grains were weighed, add them in a "
        "row `pan`",
    ),
    Case(
        "opening [mm];retained [%]\n16;0\n8;70,2\n4;28,0\n2;1,4\n",
        notice="retained [%] sums to 99.6 instead of 100; it is divided by its sum; there is no row `pan`: if the "
        "missing part passed 2 mm, give it in a row `pan`",
    ),
    Case(
        "opening [mm];mass [g]\n16;0\n11,2;410\n8;1340\n5,6;2100\n4;2400\n2,8;2490\npan;2500\n",
        notice="mass [g] rises from the coarsest sieve to the finest; if these are sums, name the column `cumulative "
        "retained [g]`",
    ),
    # Sums without a pan, with the mass of the pan instead of the total, and of three sieves with the total.
    *[
        Case(
            f"opening [mm];mass [kg]\n{rows}",
            notice="mass [kg] rises from the coarsest sieve to the finest; if these are sums, name the column "
            "`cumulative retained [kg]`",
        )
        for rows in (
            "31.5;0\n16;520\n8;1130\n4;1610\n2;1890\n1;2010\n",
            "16;0\n8;200\n4;350\n2;450\npan;4\n",
            "16;0\n8;200\n4;350\n2;450\npan;\n",
            "8;200\n4;350\n2;450\npan;454\n",
        )
    ],
    Case(
        "Siebweite [mm];Rückstand aufaddiert [g]\n16;0\n8;200\n4;350\n2;450\n",
        error="Rückstand aufaddiert [g] is a mass, but its total is unknown; give it in percent, or add the pan",
    ),
    Case(
        "opening [mm];Masse\n2,8;10\n4;100\n5,6;400\n8;1160\n11,2;2090\n16;2500\n",
        notice="Masse falls from the coarsest sieve to the finest; if these masses pass the sieves, name the column "
        "`passing [g]`",
    ),
    Case(
        "Siebanalyse Isar;;\n\nMaschenweite [mm];Rückstand [g];Bemerkung\n16;0;\n8;930;verstopft\n4;300;\nSchale;10;\n",
        notice="row 1 is above the names of the columns and is left out",
    ),
    Case(
        "opening [mm];mass [g]\n16;0\n8;1.410\n4;850\npan;12\n",
        error="row 3: mass [g] is '1.410'; if it is 1410, write it so, without a separator of thousands; if not, write "
        "another number of decimals, such as 1.4100",
    ),
    Case(
        "opening [mm];mass [g]\n63;0\n31. Mai;944\n16;810\n",
        error="row 3: opening [mm] is '31. Mai'; a spreadsheet took the number for a date: format the column as text, "
        "and enter it",
    ),
    Case(
        "opening [mm];mass [g]\n63;0\n31.5;2024-05-31 00:00:00\n16;810\n",
        error="row 3: mass [g] is "
        "'2024-05-31 00:00:00'; a spreadsheet took the number for a date: format the column as text, and enter it",
    ),
    # The decimals of the openings say nothing about the masses.
    Case(
        "opening [mm];mass [g]\n31.5;0\n16;944\n8;3.240\n4;3.807\npan;12\n",
        error="row 4: mass [g] is '3.240'; if it is 3240, write it so, without a separator of thousands; if not, write "
        "another number of decimals, such as 3.2400",
    ),
    Case("opening [mm];mass [g];note\n31.5;0;\n16;944;\n8;3.240;\n4;38.07;\npan;12;\n", notice="are not used: note"),
    Case(
        "Klasse [mm];Masse [g]\n8-16;930\n2-4;300\nSchale;10\n",
        error="no row has the class 4 to 8 mm, between rows 3 and 2; add it, with 0 if it is empty",
    ),
    Case(
        "class;mass [g]\n8-16 mm;930\n4-9 mm;300\n",
        error="the classes 4 to 9 mm (row 3) and 8 to 16 mm (row 2) overlap; correct the column class",
    ),
    Case(
        "class;mass [g]\n> 20 mm;5\n8-16 mm;930\n",
        error="no row has the class 16 to 20 mm, between rows 3 and 2; add it, with 0 if it is empty",
    ),
    Case(
        "class;mass [g]\n8-16 mm;930\n< 9 mm;300\n",
        error="the classes below 9 mm (row 3) and 8 to 16 mm (row 2) overlap; correct the column class",
    ),
    Case(
        "class;mass [g]\n8-16 mm;930\n< 8;300\n",
        error="row 3: class is '< 8' without a unit; write it as '< 8 mm', or put the unit in the header, `class [mm]`",
    ),
    Case(
        "class [mm];passing [%]\n8-16;100\n4-8;30\n",
        error="sieve classes need the mass or the percent of each class, such as `mass [g]` or `retained [%]`; if you "
        "have sums, give the openings of the sieves instead: what passes belongs to the upper sieve of a class, and "
        "what is retained in sum to its lower one",
    ),
    Case(
        "grain size [mm];mass [g]\n8-16;930\n4;300\n",
        error="row 3: grain size [mm] is '4'; give both sieves, such as '8-11.2', or an end such as '> 63'; remove "
        "rows that are no class",
    ),
    Case("class;mass [kg];passing [%]\n8-16 mm;1,410;100\n4-8 mm;0,3;20\npan;0;0\n", notice="not used: passing [%]"),
    Case(
        "opening [in];mass [g]\n3/4;10\n3/8;20\n",
        error="row 2: opening [in] is '3/4'; write a fraction as a decimal number, 0.75; row 3 has an error too",
    ),
    Case("sieve [mm];class;mass [g]\n8;8-16 mm;10\n4;4-8 mm;20\npan;;1\n", notice="columns that are not used: class"),
    Case(
        "class;mass [g]\n8-16 mm;930\nmany;300\n",
        error="row 3: class is 'many'; give both sieves, such as "
        "'8-11.2 mm', or an end such as '> 63 mm', or put the unit in the header, `class [mm]`; remove rows that are "
        "no class",
    ),
    # Tables of a reader who tried what laboratories write.
    Case(
        "Kornklasse [mm];Rückstand kumuliert [g]\n8-16;300\n4-8;900\n2-4;1000\n",
        error="sieve classes need the mass or the percent of each class, such as `mass [g]` or `retained [%]`; if you "
        "have sums, give the openings of the sieves instead: what passes belongs to the upper sieve of a class, and "
        "what is retained in sum to its lower one",
    ),
    Case(
        "class [mm];mass [g]\n16-31.5;1000\n8-16;600\n4-8;300\n2-4;90\n",
        notice="mass [g] falls from the coarsest sieve "
        "to the finest; if these masses pass the sieves, name the column `passing [g]`",
    ),
    Case(
        "Klasse [µm];Masse [g]\n< 1.000;50\n1.000/2.000;100\n2.000/4.000;150\n",
        error="the coarsest sieve is 0.004 mm, "
        "finer than sand; correct the unit of Klasse [µm], and write sizes without separators of thousands",
    ),
    Case(
        "Siebweite [mm];Durchgang [%]\n63;1\n31,5;0,85\n16;0,5\n",
        error="Durchgang [%] has no value above 1, so that its "
        "values look like fractions; write percent, such as 85 instead of 0.85, or leave the % out of the name",
    ),
    Case(
        "opening [mm];retained [%]\n16;0\n8;0.75\n4;0.25\n",
        error="retained [%] has no value above 1, so that its "
        "values look like fractions; write percent, such as 85 instead of 0.85, or leave the % out of the name",
    ),
    Case(
        "class [mm];mass [g]\n2-Apr;30\n4-8;20\n",
        error="row 2: class [mm] is '2-Apr'; a spreadsheet took the class for "
        "a date: format the column as text, and enter it",
    ),
    Case(
        "class [mm];mass [g]\n2026-04-02 00:00:00;30\n",
        error="row 2: class [mm] is '2026-04-02 00:00:00'; a spreadsheet "
        "took the class for a date: format the column as text, and enter it",
    ),
    Case(
        "class [mm];mass [g]\n2≤d<4;30\n",
        error="row 2: class [mm] is '2≤d<4'; give both sieves, such as '8-11.2', or an "
        "end such as '> 63'; remove rows that are no class",
    ),
    *[
        Case(
            f"{name};mass [g]\n{label};30\n{other};4\n",
            error=f"row 2: {name} is '{label}'; classes in phi are not read; give the classes in mm, or the "
            "openings in a column `phi`",
        )
        for name, label, other in (
            ("class [phi]", "1-2", "2-3"),
            ("class [phi]", "-4 to -3", "-3 to -2"),
            ("Klasse (φ)", "> 2", "1 bis 2"),
            ("phi class", "-4 - -3", "-3 - -2"),
            ("phi", "-4/-3", "-3/-2"),
            ("size [phi]", "3-4", "2-3"),
            ("class", "3-4 phi", "2-3 phi"),
        )
    ],
    *[
        Case(
            f"{low};{high};mass [g]\n8;16;30\n4;8;20\n",
            error=f"the columns {low} and {high} need the same unit of length; write it in both names, such as "
            f"`{low.split(' [')[0]} [mm]` and `{high.split(' [')[0]} [mm]`",
        )
        for low, high in (("from [cm]", "to [mm]"), ("from", "to"), ("von", "bis [mm]"), ("min [ell]", "max [ell]"))
    ],
    Case(
        "from [phi];to [phi];mass [g]\n-4;-3;200\n-3;-2;150\n",
        error="the columns from [phi] and to [phi] are the bounds of classes; classes in phi are not read; give the "
        "classes in mm, or the openings in a column `phi`",
    ),
    Case("from;to;opening [mm];mass [g]\n1;2;16;0\n1;2;8;60\n1;2;4;40\n", notice="columns that are not used: from, to"),
    Case("from;from [mm];to [mm];to;mass [g]\n1;8;16;2;60\n2;4;8;3;39\n", notice="columns that are not used: from, to"),
    Case(
        "class [mm];mass [g]\n> 31,5;30\n> 16;40\n",
        error="the classes above 16 mm (row 3) and above 31.5 mm (row 2) overlap; correct the column class [mm]",
    ),
    Case(
        "class [mm];mass [g]\n2-3.99;30\n4-7.99;40\n",
        error="the classes of rows 2 and 3 end and begin at 3.99 and 4 mm; write the same sieve in both",
    ),
    Case(
        "Kornklasse;Masse\n8/16;10\n4/8;20\n",
        error="row 2: Kornklasse is '8/16' without a unit; write it as '8/16 mm', or "
        "put the unit in the header, `Kornklasse [mm]`",
    ),
    Case(
        "Kornklasse [mm];Bemerkung\n8-16;nass\n",
        error="none of the columns (Kornklasse [mm], Bemerkung) has amounts; give a "
        "column of sieve openings, such as `opening [mm]` or `phi`, or of classes, such as `class [mm]` with 8-11.2, "
        "or the two columns `from [mm]` and `to [mm]`, and one of amounts, such as `mass [g]`, "
        "`retained [%]` or `passing [%]`",
    ),
    Case(
        "opening [mm];mass [g]\n16;0\n8;1 250\n4;20\n",
        error="row 3: mass [g] is '1 250'; a number is needed, without "
        "separators of thousands; write its unit, if any, in the header",
    ),
    Case(
        "opening [mm];mass [g]\n16;0\n8;1’250\n4;20\n",
        error="row 3: mass [g] is '1’250'; a number is needed, without "
        "separators of thousands; write its unit, if any, in the header",
    ),
    *[
        Case(
            text,
            notice=f"there are grains of about {size} mm, which are too large for a sieve; the unit of {name} may be "
            "µm",
        )
        for name, size, text in (
            ("opening [mm]", "2000", "opening [mm];passing [%]\n2000;100\n1000;60\n500;30\n250;10\n125;0\n"),
            ("Sieb [mm]", "1400", "Sieb [mm];Masse [g]\n2000;0\n1400;0\n1000;60\n500;30\n250;10\npan;1\n"),
            ("class [mm]", "2000", "class [mm];mass [g]\n> 2000;1\n1000-2000;60\n500-1000;30\n250-500;10\n"),
        )
    ],
    *[
        Case(
            f"Siebweite [{unit}];Durchgang [%]\n{rows}",
            error=f"row {row}: the opening {fault}order the sieves from coarse "
            "to fine or from fine to coarse, each once",
        )
        for unit, rows, row, fault in (
            (
                "mm",
                "63;100\n31,5;80\n8;50\n2;20\n1;15\n500;10\n",
                7,
                "500 mm is out of the order of the other sieves; it may be in µm, which is 0.5 mm; if not, ",
            ),
            (
                "mm",
                "500;10\n1;15\n2;20\n8;50\n63;100\n",
                2,
                "500 mm is out of the order of the other sieves; it may be in µm, which is 0.5 mm; if not, ",
            ),
            ("mm", "63;100\n3,15;80\n16;50\n8;20\n", 3, "3.15 mm is out of the order of the other sieves; "),
            ("cm", "6.3;100\n0.8;50\n0.2;20\n10;0\n", 5, "100 mm is out of the order of the other sieves; "),
            ("mm", "63;100\n31,5;80\n8;50\n2;20\n500;10\n250;0\n", 6, "500 mm follows 2 mm; "),
            ("mm", "63;100\n31,5;80\n4;50\n8;20\n2;0\n", 5, "8 mm follows 4 mm; "),
            ("mm", "8;100\n16;80\n8;50\n", 3, "16 mm follows 8 mm; "),
        )
    ],
    *[
        Case(
            text,
            error=f"the columns {names} are not named as amounts; a table has one sieve curve, so that each sample "
            "needs its own file with a column such as `mass [g]`",
        )
        for names, text in (
            ("Probe 1, Probe 2", "opening [mm];Probe 1;Probe 2\n16;0;0\n8;200,5;100\n4;100;\nSchale;5;3\n"),
            ("A [g], (no name)", "n;class;A [g];;note\n1;8-16 mm;200;1;wet\n2;4-8 mm;100;50;\n"),
        )
    ],
    *[
        Case(
            f"class [mm];{name};note\n16-32;12;5\n8-16;30;\n4-8;40;\n",
            error=f"the column {name} has counts of grains; {COUNTS}",
        )
        for name in ("count", "Counts", "Anzahl", "number of grains", "n [-]")
    ],
    *[
        Case(
            f"opening [mm],mass [g]\n16,0\n8,200\n\n4,150\n{line}\n2,100\n,\npan,10\n",
            error=f"row 6: the line is a comment, '{text}'; remove it",
        )
        for line, text in (
            ("# comment", "# comment"),
            ("#wet!,", "#wet!"),
            ("# sieved, then dried", "# sieved then dried"),
            ("# sieved, dried, weighed on 5 May", "# sieved dried weighed on 5 May"),
        )
    ],
    *[
        Case(
            f"opening [mm],mass [g]\n16,0\n{cells}\n4,150\n",
            error=f"row 3: {name} is '{text}', an error of the spreadsheet; correct its formula",
        )
        for cells, name, text in (
            ("8,#DIV/0!", "mass [g]", "#DIV/0!"),
            ("8,#N/A", "mass [g]", "#N/A"),
            ("#BEZUG!,200", "opening [mm]", "#BEZUG!"),
            ("#DIV/0!,", "opening [mm]", "#DIV/0!"),
            ("#WERT!,#WERT!", "opening [mm]", "#WERT!"),
        )
    ],
    Case(
        "opening [mm],mass [g]\n16,0\n# 10,200\n4,150\n",
        error="row 3: opening [mm] is '# 10', a number of a sieve; give its opening instead, in mm",
    ),
    # Both marks are decimals elsewhere, or no cell shows which mark is.
    Case("Sieböffnung [mm];Summenrückstand [%];note\n16;0;a\n8;60;b\n4;100;c\n", notice="are not used: note"),
    Case("Öffnung [mm];Durchgangssumme [%];note\n16;100;a\n8;60;b\n4;0;c\n", notice="are not used: note"),
    Case("opening [mm];mass [kg];note\n16;0,5;a\n8;1.410;b\n4;0.7;c\npan;0;d\n", notice="are not used: note"),
    Case("opening [mm];mass [kg];note\n16;0;a\n8;1.410;2,5\n4;1.125;c\npan;0;d\n", notice="are not used: note"),
]

# Tables of classes, and the same table of sieves.
SAME_SIEVES = [
    (
        "Passing (mm),Retained on (mm),Mass (g)\n16,11.2,70\n11.2,8,1930\n8,4,300\n4,-,10.5\n",
        "opening [mm];mass [g]\n16;0\n11,2;70\n8;1930\n4;300\npan;10,5\n",
    ),
    (
        "Sieve retained [cm];Sieve passed [cm];% of mass\n0.8;1.6;60\n0.4;0.8;40\n",
        "opening [mm];retained [%]\n16;0\n8;60\n4;40\n",
    ),
    (
        "class [mm];mass [g]\n8-16;930\n4-8;300\n0-4;10\n",
        "opening [mm];mass [g]\n16;0\n8;930\n4;300\npan;10\n",
    ),
    (
        "Korngröße [mm];Masse [g]\nSchale;10,5\n4 – 8;300\n11,2/16;70\n8 bis 11,2;1930\nSumme;2310,5\n",
        "opening [mm];mass [g]\n16;0\n11,2;70\n8;1930\n4;300\npan;10,5\n",
    ),
    (
        "sieve class;retained [%];passing [%]\n> 16 mm;0.5;100\n8-16 mm;60;99.5\n4-8 mm;39;39.5\n< 4 mm;0.5;0.5\n",
        "opening [mm];retained [%]\n16;0.5\n8;60\n4;39\npan;0.5\n",
    ),
    (
        "Kornfraktion (mm);Anteil [Gew.-%]\n+63;2\n31,5 – 63;18\n8 à 31,5;60\nkleiner 8;20\n",
        "Sieb [mm];Rückstand [M.-%]\n63;2\n31,5;18\n8;60\npan;20\n",
    ),
    (
        "Fraction [mm];Auswaage [g];Durchgang [%]\n63+;20\n31.5—63;180;98\n8…31.5;600;80\n-8;200;20\n",
        "ouverture [mm];masse [g]\n63;20\n31.5;180\n8;600\npan;200\n",
    ),
    (
        "Probe;bis [mm];von [mm];Masse [g]\na;2;;10,5\na;4;2;300\na;8;4;1930\na;;8;70\na;;Summe;2310,5\n",
        "opening [mm];mass [g]\n8;70\n4;1930\n2;300\npan;10,5\n",
    ),
    (
        "min [mm];max [mm];class [mm];mass [g]\n7.9;17;8-16;60\n3.9;8.5;4-8;39.5\n2.1;4;2-4;0.5\n",
        "opening [mm];mass [g]\n16;0\n8;60\n4;39.5\n2;0.5\n",
    ),
    (
        "from [cm];to [cm];opening [mm];mass [g]\n0;20;16;0\n0;20;8;60\n0;20;4;39.5\n0;20;2;0.5\n",
        "opening [mm];mass [g]\n16;0\n8;60\n4;39.5\n2;0.5\n",
    ),
    (
        "lower [mm];upper [mm];mass [g]\n16 mm;∞;10\n8 mm;16 mm;60\n2;8 mm;40\n-;2 mm;1\ntotal;;111\n",
        "opening [mm];mass [g]\n16;10\n8;60\n2;40\npan;1\n",
    ),
    (
        "from (cm),to (cm),retained [%]\n0.8,1.6,60\n0.4,0.8,39.5\n0.2,0.4,0.5\n",
        "opening [mm],retained [%]\n16,0\n8,60\n4,39.5\n2,0.5\n",
    ),
    (
        "Sieve analysis, Rhine km 640\nDate:;12.03.2025\n\nopening;mass;note\n[mm];[g];-\n16;0;\n8;60,5;wet\n4;39,5;\n",
        "opening [mm];mass [g]\n16;0\n8;60,5\n4;39,5\n",
    ),
    (
        "Sieve analysis of the Rhine\nsize,passing\nmm,%\n16,100\n8,40.5\n4,0\n",
        "opening [mm];passing [%]\n16;100\n8;40.5\n4;0\n",
    ),
    (
        "size passing\nmm %\n16 100\n8 40,5\n4 0\n",
        "opening [mm];passing [%]\n16;100\n8;40,5\n4;0\n",
    ),
    (
        "size [µm];mass [g]\n500-1000;20\n1000-2000;30\n",
        "opening [mm];mass [g]\n2;0\n1;30\n0.5;20\n",
    ),
]

GRAINS = [
    Case(
        "L [mm];I [mm];S [mm]\n40,5;30;10\n31. Mai;20;12\n",
        error="row 3: L is '31. Mai'; a spreadsheet took the number for a date: format the column as text, and "
        "enter it",
    ),
    Case(
        "L [mm];I [mm];S [mm]\n12 inch;3;2\n",
        error="row 2: L is '12 inch'; a number is needed; write its unit, if any, in the header",
    ),
    Case(
        "L [mm];I [mm];S [mm]\n4;3;2\n5;NA;3\n6;4;3\n",
        error="row 3: I is 'NA'; a number is needed; enter it, or remove the row",
    ),
    Case(
        "L [mm];I [mm];S [mm]\n4.1 ± 0.2;3;2\n",
        error="row 2: L is '4.1 ± 0.2'; a number is needed; write its error into a column of its own",
    ),
    Case(
        "sample;number;mean_FL;std_FL;mean_EL;std_EL\n"
        + "".join(f"{'abcdef'[i]};{number};.6;.1;.7;.1\n" for i, number in enumerate((101, 103, 107, 108, 109, 112))),
        error="the numbers in the column number rise from row to row; rename the column to `id` if they number the "
        "samples, or to `count` if they are numbers of grains",
    ),
    Case(
        "number;FL;EL\n11;.5;.7\n12;.6;.7\n14;.5;.6\n15;.5;.7\n17;.6;.7\n18;.5;.6\n",
        error="the numbers in the column number rise from row to row; rename the column to `id` if they number the "
        "grains, or to `count` if they are numbers of grains",
    ),
    Case(
        "L;I;S\n40,5;30;10\n1.250;800;500,5\n",
        error="row 3: L is '1.250', but this table writes decimals with a comma (40,5); write numbers without "
        "separators of thousands",
    ),
    Case(
        "L;I;S\n40;30;10\n12;10;\n10;12;8\n9;8;7\n",
        error="row 3: S is empty; measure it, or remove the row; row 4 has an error too",
    ),
    Case(
        "FL;EL\n" + "65;70\n" * 8,
        error="row 2: FL = 65 is not in (0, 1]; FL is S/I and EL is I/L; do not give their inverses or percent; rows "
        "3, 4, 5, 6, 7 and 2 more have errors too",
    ),
    Case(
        "sample;mean_FL;std_FL;mean_EL;std_EL\nA;.6;.7;.7;.1\nB;.6;.1;7;.1\n",
        error="row 2: std_FL = 0.7; with a mean of 0.6 it is between 0 and 0.49; give the standard deviation, not the "
        "variance or a percentage; row 3 has an error too",
    ),
    Case(
        "mean_FL;mean_EL\n.6;.7\n",
        error="the columns std_FL, std_EL are missing beside mean_FL, mean_EL (if they were not measured, give those "
        "of similar grains, such as 0.175 and 0.139 of the Rhine's gravel; 0 means that all grains have one form); "
        + NEEDED,
    ),
    Case(
        "flatness;elongation\n.6;.7\n",
        error="flatness and elongation may be defined in several ways; if FL = S/I and EL = I/L are meant, name the "
        f"columns FL and EL; {NEEDED}",
    ),
    Case(
        "L [ell];I [ell];S [ell]\n4;3;2\n",
        error="the column L [ell] has the unknown unit 'ell'; axes are in m, cm, mm, µm, in, ft or pixels; " + NEEDED,
    ),
    Case(
        "FL;EL;Count [Percent]\n.6;.7;40\n.5;.7;60\n",
        notice="the column Count [Percent] is the weight of each row; the number of grains is unknown",
    ),
    Case("L;I;S\n40;30;10\n\n12;10;\n", error="row 4: S is empty; measure it, or remove the row"),
    Case("L;I;S;note\n40;;10;wet\n", error="row 2: I is empty; measure it, or remove the row"),
    Case("L;I;S\n40;30;10\n# Ende\n", error="row 3: the line is a comment, '# Ende'; remove it"),
    Case("L I S\n40 30 10\n# the end of it\n", error="row 3: the line is a comment, '# the end of it'; remove it"),
    Case(
        "L;I;S\n40;30;10\n#NAME?;3;2\n",
        error="row 3: L is '#NAME?', an error of the spreadsheet; correct its formula",
    ),
    Case("id;L;I;S\n#a;4;3;2\n#b;4;3;1\n", notice="id"),
    Case("L;I;S\n40;30\n", error="row 2: the row has 2 fields, but the header has 3; add or remove fields"),
    Case(
        "L,,I,S,\n40,,30\n",
        error="row 2: the row has 2 fields, but the header has 3; add or remove fields, and "
        "write decimals with a point, because commas separate the fields",
    ),
    Case(
        "L;I;S\n40;30;10;5;3\n",
        error="row 2: the row has 5 fields, but the header has 3; add or remove fields; if there is a title above the "
        "names of the columns, remove it",
    ),
    # The title has two numbers, so it may be a row of the table.
    Case(
        "640;2025\nL;I;S\n40;30;10\n",
        error="row 2: the row has 3 fields, but the header has 2; add or remove fields; if there is a title above the "
        "names of the columns, remove it",
    ),
    Case(
        "L;I;S\n40;30;10\n30;20;15\n50;40;20\n41;28;17\n;;\n40,25;29,5;15,5\n28;20;10\n50;40;20\n",
        notice="row 7 has the means of the rows above of the same sample; if this is no grain, remove it, and other "
        "statistics below it",
    ),
    *[
        Case(
            f"{above}\n;a;b;c\n{rows}",
            error=f"column 1 has values but no name in row {row}; write its name there ({remedy})",
        )
        for above, rows, row, remedy in [
            ("site;axes [mm]", "A;4;3;2\nA;5;4;3\nB;4;3;1\n", 2, "row 1 has site"),
            ("Isar, 12.03.2021\nSample;axes", "A;4;3;2\n;5;4;3\nB;4;3;1\n", 3, "row 2 has Sample"),
        ]
    ],
    # The column with the numbers of the rows needs no name.
    Case("Isar\n;a;b;c\n1;4;3;2\n2;5;4;3\n3;4;3;1\n", notice="columns that are not used: (column 1, no name)"),
    Case("L;I;S\nmm;mm;mm\n40;30;10\n", notice="row 2 has the units of the columns"),
    Case(
        "sample;L;I;S\nunit;[cm];[cm];[mm]\nA;4;3;10\n",
        error="the header mixes units (L in cm, I in cm, S in mm); give all three axes in one unit; row 2 has "
        "the units of the columns",
    ),
    Case(
        "FL;EL\n%;%\n65;70\n",
        error="the column FL [%] is in percent; give FL as a fraction, 0.65 not 65; row 2 has the units of the columns",
    ),
    Case('note;L;I;S\n"wet;\ncold";40;30;10\n"dry";40;30;\n', error="row 3: S is empty; measure it, or remove the row"),
    Case(
        "Kiesprobe Isar km 120;;;\nDatum: 12.03.2021;;;\n;;;\nNr.;a [cm];b [cm];c [cm]\n1;1,45;1,03;0,40\n",
        notice="row 1, row 2 are above the names of the columns and are left out",
    ),
    Case(
        "mean_FL;std_FL;mean_EL;std_EL;grains\n.6;.1;.7;.1;40\n.6;.1;.7;.1;1\n",
        error="row 3: a single grain has no standard deviation, but sample row 3 has one; correct the number of grains "
        "or the deviations; if that column numbers the rows, rename it to `id`",
    ),
    *[
        Case(f"mean_FL;std_FL;mean_EL;std_EL;{names}\n.6;.1;.7;.1;{first}\n.7;.1;.7;.1;{second}\n", notice=notice)
        for names, first, second, notice in [
            ("grains [%]", "40", "60", "the column grains [%] is not used, because it is in percent"),
            ("n;grains", ".31;40", ".33;30", "the column grains is the number of grains of each sample"),
            ("n", "0.31", "0.33", "the column n is not used, because 0.31 in row 2 is no number of grains"),
            ("count", "40", "", "the column count is not used, because row 3 has no number of grains"),
            ("n", "1", "2", "the column n numbers the rows, so it is not used as a number of grains"),
            ("grains", "2", "3", "the column grains is the number of grains of each sample"),
            ("grains", "40", "41", "the column grains is the number of grains of each sample"),
        ]
    ],
    *[
        Case(
            f"{name};FL;EL\n" + "".join(f"{number};0.5;0.{7 + i % 2}\n" for i, number in enumerate(numbers)), "", notice
        )
        for name in ("n", "count")
        for numbers, notice in [
            ((3, 1, 2, 6, 4, 5), f"the column {name} numbers the rows, so it is not used as a number of grains"),
            ((1, 2, 3, 4, 1, 2), f"the column {name} numbers the rows, so it is not used as a number of grains"),
            ((1, 2, 1, 2, 1, 2), f"the column {name} is the number of grains of each row, 9 in all"),
            ((2, 3, 4, 2, 3, 4), f"the column {name} is the number of grains of each row, 18 in all"),
            ((2, 1, 3), f"the column {name} is the number of grains of each row, 6 in all"),
        ]
    ],
    Case(
        "count;FL;EL\n0;.5;.7\n1;.5;.8\n2;.5;.7\n", notice="the column count is the number of grains of each row, 3 in"
    ),
    Case(
        "sample;a [cm];b [cm];c [cm]\nleft;4;3;2\nright;4;3;1\nboth;4;3;1\nboth;4;2;1\n",
        notice="the samples left, right have one row each, so that all grains have one form; if the row is a mean over "
        "grains, the porosity is too low: give a row per grain, or mean_FL, std_FL, mean_EL, std_EL",
    ),
    Case(
        "FL;EL;count\n0.5;0.7;120\n",
        notice=" has one row, so that all grains have one form; if the row is a mean over grains, the porosity is too",
    ),
    Case(
        "site;mean_FL;std_FL;mean_EL;std_EL\na;.6;.016;.7;.1\nb;.6;.1;.7;0\nc;.6;.1;.7;.012\n",
        notice="std_FL or std_EL is below 0.06, which is rare for gravel; give the standard deviation over the grains, "
        "not the standard error of their mean or the variance",
    ),
    Case(
        "Fraktion;L;I;S\n8-11,2;14;10;4\n8-11,2;13;10;6\n11,2–16 mm;16;11;3\n",
        notice="the column Fraktion is not used; its values look like sieve classes (8-11,2, 11,2–16 mm); to give "
        "forms by class beside a sieve curve, rename the column to `class`",
    ),
    Case(
        "L;I;S\n40;30;10\n41;30;2,1\n453;31;12\n42;30;9\n",
        notice="rows 3, 4: S/I or I/L is 0.1 or less, which is rare for gravel; check the decimal marks",
    ),
    Case(
        "FL;EL\n0.06;0.7\n",
        notice="row 2: S/I or I/L is 0.1 or less, which is rare for gravel; check the decimal marks",
    ),
    Case(
        "Probe;bed;L;I;S\nA;1;14;10;4\nB;1;13;10;6\n", notice="the samples A, B have one row each, so that all grains"
    ),
    Case(
        "BETT;L;I;S\nA;14;10;4\n;13;10;6\n",
        error="row 3: BETT is empty; name the sample in every row (merged cells of a workbook count as empty)",
    ),
    Case("month;L;I;S\n3/2021;14;10;4\n4/2021;13;10;6\n", notice="columns that are not used: month"),
    Case("date;L;I;S\n2021-03;14;10;4\n2021-03;13;10;6\n", notice="columns that are not used: date"),
    Case("Klasse;L;I;S\n8-16;14;10;4\n", notice="columns that are not used: Klasse"),
    Case(
        "sample;L;I;S\na;14;10;4\n;13;10;6\n",
        error="row 3: sample is empty; name the sample in every row (merged cells of a workbook count as empty)",
    ),
    Case("Nr.;Länge;Breite;Höhe\n1;14,5;10,3;4,0\n", notice="columns that are not used: Nr."),
    Case("grain,length [mm],breadth [mm],height [mm]\n1,14.5,10.3,4.0\n", notice="are not used: grain"),
    Case("grain;a-Achse;b-Achse;c-Achse\n1;14,5;10,3;4,0\n", notice="are not used: grain"),
    Case("grain;Achse a [cm];Achse b [cm];Achse c [cm]\n1;14,5;10,3;4,0\n", notice="are not used: grain"),
    Case("grain;lang;mittel;kurz\n1;14,5;10,3;4,0\n", notice="are not used: grain"),
    Case("grain;dL;dI;dS\n1;14,5;10,3;4,0\n", notice="are not used: grain"),
    Case("grain;L [cm];B [cm];H [cm]\n1;14,5;10,3;4,0\n", notice="are not used: grain"),
    Case(
        "L I S\n40 30\n",
        error="row 2: the row has 2 fields, but the header has 3; add or remove fields; blanks separate the columns, "
        "also inside their names: separate the columns with semicolons or tabs",
    ),
    Case(
        'sample,grains,mean_FL,std_FL,mean_EL,std_EL\nA,"1,200",0.6,0.1,0.7,0.1\nB,50,0.6,0.1,0.7,0.1\n',
        error="row 2: grains is 1,200; write it without a separator of thousands",
    ),
    Case("L;I;S;note\n40,5;30;10\n4.5;2;1\n4.125;2;1;wet\n", notice="columns that are not used: note"),
]

# Tables with a column of sieve classes. Those without an error and a notice are read.
CLASSES = [
    Case(
        "class;L;I;S\n8-11,2 mm;14;10;4\n8;13;10;6\n",
        error="row 3: class is '8'; give both sieves, such as '8-11.2 mm', or an end such as '> 63 mm', or put the "
        "unit in the header, `class [mm]`; remove rows that are no class",
    ),
    Case(
        "class [mm];L;I;S\n8-11,2;14;10;4\n\n8;13;10;6\n",
        error="row 4: class [mm] is '8'; give both sieves, such as '8-11.2', or an end such as '> 63'; remove rows "
        "that are no class",
    ),
    Case(
        "Klasse;L;I;S\n11,2-16 mm;14;10;4\n11,2-16 mm;13;10;6\n8-11,2;13;10;6\n",
        error="row 4: Klasse is '8-11,2' without a unit; write it as '8-11,2 mm', or put the unit in the header, "
        "`Klasse [mm]`",
    ),
    Case(
        "Siebklasse;FL;EL\n8-11,2 mm;0,5;0,7\n;0,6;0,8\n",
        error="row 3: Siebklasse is empty; write it in every row (merged cells of a workbook count as empty)",
    ),
    Case(
        "class;L;I;S\n8-11,2 ells;14;10;4\n",
        error="row 2: class is '8-11,2 ells'; its unit 'ells' is unknown, use m, cm, mm, µm, in",
    ),
    Case(
        "class;L;I;S\n16-8 mm;14;10;4\n",
        error="row 2: class is '16-8 mm'; give the smaller size first",
    ),
    Case(
        "class [in];L;I;S\n3/8;14;10;4\n",
        error="row 2: class [in] is '3/8', which may be a fraction of an inch; write a class as '3-8'",
    ),
    Case(
        "class;L;I;S\n8-16 mm;14;10;4\n0,8-1,6 cm;14;10;4\n",
        error="8-16 mm and 0,8-1,6 cm are the same class; write it in one way in the column class",
    ),
    Case("Klasse;L;I;S\n8-11,2 mm;14;10;4\n11,2-16 mm;13;10;6\n"),
    Case("class;L;I;S\n8/11,2 mm;14;10;4\n11,2 bis 16 mm;13;10;6\n"),
    Case("classe (mm);Länge;Breite;Dicke\n8 à 11,2;14;10;4\n11,2−16;13;10;6\n"),
    Case(
        "class [mm];FL;EL\n< 9;0,6;0,7\n8-16;0,5;0,8\n",
        error="the classes below 9 mm and 8 to 16 mm overlap; correct the column class [mm]",
    ),
    Case(
        "class [mm];FL;EL\npan;0,6;0,7\n",
        error="row 2: class [mm] is 'pan'; write it with the finest sieve, such as '< 2'",
    ),
    Case("Siebklasse [mm];L;I;S\n8-11,2;14;10;4\n11,2-16;13;10;6\n"),
    Case(
        "Klasse [mm];L;I;S\n8-11,2;14;10;4\n11,2-16;13;10;6\n11,2-16;15;9;6\n",
        notice="the class 8-11,2 has one row, so that all grains have one form; if the row is a mean over grains, the",
    ),
    Case(
        "Klasse [mm];L;I;S\n8-11,2;14;10;4\n11,2-16;13;10;6\n",
        notice="the classes 8-11,2, 11,2-16 have one row each, so that all grains have one form; if the row is a mean",
    ),
    Case(
        "class [mm];mean_FL;std_FL;mean_EL;std_EL;n\n8-11.2;.6;.02;.7;.1;40\n11.2-16;.6;.1;.7;.1;30\n",
        notice="the class 8-11.2: std_FL or std_EL is below 0.06, which is rare for gravel; give the standard",
    ),
    Case(
        "class [mm];mean_FL;std_FL;mean_EL;std_EL;n\n8-11.2;.6;.1;.7;.1;40\n11.2-16;.6;.1;.7;.1;30\n",
        notice="the column n is the number of grains of each class; FL and EL are assumed to be independent",
    ),
    Case(
        "class [mm];FL;EL\n8-11.2;0.5;0.7\n8-11.2;0.7;0.5\n8-11.2;0.9;0.9\n8-11.2;0.7;0.7\n11.2-16;0.7;0.7\n",
        notice="row 5 has the means of the rows above of the same class; if this is no grain, remove it, and other",
    ),
    Case(
        "class [mm];mean_FL;std_FL;mean_EL;std_EL\n8-16;.6;.1;.7;.1\n8-16;.6;.1;.7;.1\n",
        error="row 3: class 8-16 occurs twice, but each row of means and deviations is one class; rename or remove one",
    ),
    Case(
        "class [mm];FL;EL;count\n8-16;.6;.7;0\n8-16;.5;.7;0\n16-32;.6;.7;5\n",
        error="the numbers of grains of class 8-16 are all 0; correct or remove its rows",
    ),
    Case("Kornklasse (cm);L;I;S\n0,8-1,12;14;10;4\n11,2-16 mm;13;10;6\n"),
    Case("size class [µm];L;I;S\n8000-11200;14;10;4\n1.12-1.6 cm;13;10;6\n"),
]
