"""The page as a person uses it: keyboard, screen reader, link, files, phone."""

from urllib.parse import urlencode

import pytest

from simcore.paths import ROOT
from simcore.scene.specification import read_specification

SIEVES = "Siebweite [mm];Masse [g]\n16;0\n8;400,5\n4;200\n2;50\n"
GERMAN = "L [mm];I [mm];S [mm]\n42,5;31;18\n38;29,5;24\n55;30;21\n"


def fragment(**state):
    return f"#{urlencode(state)}"


def answer(page):
    return page.locator("#answer").inner_text()


def test_the_link_keeps_the_input(open_page):
    page = open_page()
    page.get_by_label("Table of grains").fill(GERMAN)
    page.get_by_label("Sieve curve").select_option("U1")
    page.get_by_label("Prediction interval").select_option("0.8")
    shown, address = answer(page), page.url
    assert "80 % prediction interval" in shown
    again = open_page(address[address.index("#") :])
    assert answer(again) == shown
    assert again.get_by_label("Table of grains").input_value() == GERMAN


def test_it_states_the_error_of_few_grains_or_its_absence(open_page):
    axes = (ROOT / "examples" / "grains.csv").read_text()
    stated, absent = (
        "has a standard error of 0.004, which the interval contains",
        "do not contain the error of measuring",
    )
    for table, text in (
        (axes, stated),
        ("mean_FL,std_FL,mean_EL,std_EL\n0.6,0.15,0.7,0.12\n", absent),
        ("L,I\n" + "".join(f"{L},10\n" for L in range(12, 20)), absent),
    ):
        page = open_page(fragment(table=table))
        assert text in page.locator("#caveats").inner_text()


def test_grains_with_two_axes_have_no_advice_on_their_error(open_page):
    page = open_page(fragment(table="L,I\n" + "".join(f"{L},10\n" for L in range(12, 20))))
    caveats = page.locator("#caveats").inner_text()
    assert "The intervals do not contain the error of measuring few grains." in caveats
    assert "it is known if" not in caveats


def test_another_table_without_the_chosen_column_is_read(open_page):
    page = open_page(fragment(table="Site;FL;EL\na;0.6;0.7\na;0.5;0.6\nb;0.6;0.8\nb;0.7;0.8\n"))
    page.get_by_label("Column that names the sample").select_option("Site")
    assert page.locator("#rows tr").count() == 2
    table = page.get_by_label("Table of grains")
    table.fill(table.input_value().replace("0.8", "0.75"))
    assert page.get_by_label("Column that names the sample").input_value() == "Site"
    table.fill(GERMAN)
    assert page.locator("#error").inner_text() == "" and "n = 0." in answer(page)


def test_decimal_commas_are_read_and_written(open_page):
    points, commas = (open_page(fragment(table=text, mark=",")) for text in (GERMAN.replace(",", "."), GERMAN))
    assert answer(commas) == answer(points)
    assert "n = 0," in answer(commas)


def test_it_is_used_by_keyboard_alone(open_page):
    page = open_page()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "table"
    page.keyboard.insert_text(GERMAN)
    assert "n = 0." in answer(page)
    reached = []
    for _ in range(20):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.id"))
    wanted = ["file", "example-grains", "example-means", "clear", "case", "level", "column", "mark"]
    assert [name for name in reached if name in wanted][: len(wanted)] == wanted
    page.locator("#example-means").focus()
    page.keyboard.press("Enter")
    assert page.locator("#rows tr").count() == 2
    page.locator("#chosen").focus()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    assert page.locator("#chosen").input_value() == "Lune"


def test_each_control_and_drawing_has_a_name_for_screen_readers(open_page):
    page = open_page(fragment(table=GERMAN, case="own", sieves=SIEVES))
    unnamed = page.evaluate("""
      [...document.querySelectorAll("input:not([type=hidden]), select, textarea, button, svg, [role=slider]")]
        .filter((node) => !(node.labels?.length || node.getAttribute("aria-label") || node.innerText?.trim()))
        .map((node) => node.outerHTML.slice(0, 80))""")
    assert unnamed == []
    assert "Zingg diagram: table at flatness 0." in page.locator("#zingg svg").get_attribute("aria-label")
    assert page.locator("#answer").get_attribute("aria-live") == "polite"


def test_a_fault_is_announced_and_no_porosity_is_shown(open_page):
    page = open_page(fragment(table="FL,EL\n0.6,1.7\n"))
    assert page.get_by_role("alert").inner_text().startswith("table, row 2: EL = 1.7 is not in (0, 1]")
    assert page.locator("#results").is_hidden()


def test_without_an_interval_none_is_called_wider(open_page):
    page = open_page(fragment(table="mean_FL,std_FL,mean_EL,std_EL\n0.65,0.12,0.7,0.095\n", case="U7"))
    assert "None of our models is used" in answer(page)
    assert "* Outside the fitted range: std. dev. EL = 0.095" in answer(page)


def test_a_sample_far_outside_is_refused(open_page):
    page = open_page(fragment(table="FL,EL\n0.15,0.2\n", case="U1"))
    assert "cannot be predicted" in answer(page)
    assert "n =" not in answer(page)


def test_files_in_latin_1_are_opened(open_page, tmp_path):
    path = tmp_path / "körner.csv"
    path.write_bytes("Körner;L;I;S\nüber;42,5;31;18\n".encode("cp1252"))
    page = open_page()
    page.get_by_label("Open a file").set_input_files(path)
    page.locator("#answer strong").wait_for()
    assert "n = 0." in answer(page)
    assert "read as Windows-1252" in page.locator("#notices").inner_text()


def test_a_workbook_is_refused_with_the_cure(open_page, tmp_path):
    path = tmp_path / "grains.xlsx"
    path.write_bytes(b"PK\x03\x04" + bytes(40))
    page = open_page()
    page.get_by_label("Open a file").set_input_files(path)
    page.locator("#error:not(:empty)").wait_for()
    assert "copy the cells and paste them here" in page.get_by_role("alert").inner_text()


@pytest.mark.parametrize("case", ["one-class", "U1", "U7", "B50"])
@pytest.mark.parametrize("table", [GERMAN, "FL;EL\n0,6;0,7\n"])
def test_the_specification_packs_the_sample(open_page, tmp_path, case, table):
    page = open_page(fragment(table=table, case=case))
    with page.expect_download() as download:
        page.get_by_role("button", name="Specification that packs it").click()
    path = tmp_path / "packing.yaml"
    download.value.save_as(path)
    shapes = read_specification(path)["shapes"]
    if table != GERMAN:
        assert (shapes["flatness"], shapes["elongation"]) == ({"mean": 0.6, "std": 0}, {"mean": 0.7, "std": 0})
    else:
        assert shapes["flatness"]["mean"] == pytest.approx((18 / 31 + 24 / 29.5 + 21 / 30) / 3, abs=1e-6)


@pytest.mark.parametrize("width", [320, 400, 1400])
@pytest.mark.parametrize("sizes", [{"case": "U1"}, {"case": "own", "sieves": SIEVES}])
def test_nothing_is_wider_than_the_screen(open_page, width, sizes):
    page = open_page(fragment(table=GERMAN, **sizes), width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
