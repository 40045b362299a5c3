"""The sieve curve as a person gives it: pasted, drawn by mouse and by keyboard, kept in the link."""

from urllib.parse import urlencode

import pytest

from simcore.models.size_and_form.bed_prediction_text import CHECK_BY_CLASS, OTHER_BEDS, STATE
from simcore.scene.specification import read_specification

SIEVES = "Siebweite [mm];Masse [g]\n16;0\n8;400,5\n4;200\n2;50\n"


def open_curve(open_page, sieves=SIEVES, **state):
    return open_page("#" + urlencode({"case": "own", "mark": ",", "sieves": sieves, **state}))


def drawn(page):
    """Return the table that the chart wrote: opening [mm] to passing [%]."""
    header, *rows = page.locator("#sieves").input_value().splitlines()
    assert header == "opening [mm];passing [%]"
    return {
        float(size.replace(",", ".")): float(share.replace(",", ".")) for size, share in (r.split(";") for r in rows)
    }


def porosity(page):
    return page.locator("#answer strong").inner_text()


def test_a_curve_alone_has_the_porosity_of_the_rhines_form(open_page):
    page = open_curve(open_page)
    assert "the form is that of the Rhine's gravel" in page.locator("#notices").inner_text()
    assert STATE in page.locator("#answer").inner_text() and OTHER_BEDS in page.locator("#answer").inner_text()
    assert "placed and not shaken" in page.locator("#answer").inner_text()
    labels = page.locator("#predictions svg").get_attribute("aria-label")
    assert all(name in labels for name in ("long shaken to not shaken", "linear mixture", "rods", "Wooster 2008"))
    assert page.locator("#classes tr").count() == 3


def test_the_link_keeps_the_curve(open_page):
    page = open_curve(open_page, "opening [mm];passing [%]\n16;100\n8;60\n4;20\n")
    assert "give the size of the finest" in page.locator("#curve-error").inner_text()
    page.get_by_label("Finest grains").fill("1,5 mm")
    shown, address = porosity(page), page.url
    again = open_page(address[address.index("#") :])
    assert porosity(again) == shown
    assert again.get_by_label("Finest grains").input_value() == "1,5 mm"
    assert again.locator("#sieves").input_value() == page.locator("#sieves").input_value()


def test_a_size_that_is_no_number_has_the_cure_of_a_field(open_page):
    page = open_curve(open_page, finest="20 µm")
    assert page.locator("#curve-error").inner_text() == "Finest grains is '20 µm'; give a size above 0, in mm."


def test_a_size_with_a_separator_of_thousands_is_refused(open_page):
    page = open_curve(open_page, finest="1,000")
    assert page.locator("#curve-error").inner_text() == "Finest grains is '1,000'; write 1000 or 1, in mm."


def test_a_damaged_decimal_mark_of_a_link_is_ignored(open_page):
    page = open_page("#table=FL%3BEL%0A.5%3B.7%0A&mark=x")
    assert page.locator("#answer strong").inner_text()[:2] in ("0.", "0,")


def test_a_faulty_curve_has_no_chart_to_edit(open_page):
    page = open_curve(open_page)
    assert page.locator("#curve-chart svg").count() == 1
    page.get_by_label("Table of sieves").fill("opening [mm];mass [g]\n16;x\n")
    assert page.locator("#curve-chart svg").count() == 0 and page.locator("#curve-error").inner_text()
    page.get_by_label("Table of sieves").fill(SIEVES)
    assert page.locator("#curve-chart svg").count() == 1


def test_a_curve_is_drawn_by_keyboard(open_page):
    page = open_page("#case=own&mark=,")
    page.locator("#draw-curve").focus()
    page.keyboard.press("Enter")
    before = porosity(page)
    page.locator("[data-point='2']").focus()
    handle = page.locator("[data-point='2']")
    assert handle.get_attribute("aria-valuetext") == "18 % pass 5,6 mm"
    for key in ("ArrowUp", "PageUp", "ArrowRight"):
        page.keyboard.press(key)
    assert handle.get_attribute("aria-valuetext") == "29 % pass 5,71 mm"
    assert drawn(page)[5.71] == 29
    page.keyboard.press("End")
    assert drawn(page)[5.71] == drawn(page)[8] == 32, "no more passes a sieve than the next coarser one"
    page.keyboard.press("+")
    assert len(drawn(page)) == 9
    page.keyboard.press("Delete")
    assert len(drawn(page)) == 8
    assert page.evaluate("document.activeElement.getAttribute('role')") == "slider"
    assert porosity(page) != before


def test_a_curve_is_drawn_by_mouse(open_page):
    page = open_curve(open_page)
    chart = page.locator("#curve-chart svg")
    chart.scroll_into_view_if_needed()
    box = page.locator("[data-point='2']").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    before = porosity(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 2, y + 55, steps=3)
    page.mouse.up()
    height = page.locator(".field").bounding_box()["height"]
    share = 100 * (250 / 650.5 - 55 / height)
    assert drawn(page)[8] == pytest.approx(share, abs=1.5)
    assert porosity(page) != before
    page.mouse.click(x + 25, y - 40)
    assert len(drawn(page)) == 5


@pytest.mark.parametrize("table", ["", "FL;EL\n0,6;0,7\n"])
def test_the_specification_is_accepted(open_page, tmp_path, table):
    page = open_curve(open_page, table=table)
    with page.expect_download() as download:
        page.get_by_role("button", name="Specification that packs it").click()
    download.value.save_as(tmp_path / "packing.yaml")
    specification = read_specification(tmp_path / "packing.yaml")
    assert specification["shapes"]["choice"] == ("form_distribution" if table else "random")
    assert len(specification["sizes"]["mass_fractions"]) == 3


def test_a_specification_of_many_grains_has_a_notice(open_page):
    page = open_curve(open_page, "opening [mm];passing [%]\n63;100\n16;45\n4;18\n2;0\n")
    with page.expect_download():
        page.get_by_role("button", name="Specification that packs it").click()
    said = page.locator("#copied").inner_text()
    assert said.startswith("The packing has 630 000 grains, most of them fine, and takes days on one core")
    assert "leave out the grains below 4 mm, which are 18% of the mass" in said
    page.get_by_label("Coarsest grains").fill("90")
    assert page.locator("#copied").inner_text() == ""


def test_each_sieve_class_may_have_its_form(open_page):
    page = open_curve(open_page, table="class;FL;EL\n2-8 mm;0,6;0,7\n8-16 mm;0,4;0,7\n")
    by_class = porosity(page)
    assert CHECK_BY_CLASS in page.locator("#answer").inner_text()
    assert "because the sieve curve has no mass there" not in page.locator("#notices").inner_text()
    assert "candidate" in page.locator("#formula").inner_text()
    assert page.get_by_role("button", name="Specification that packs it").is_disabled()
    page = open_curve(open_page, table="class;FL;EL\n0-1 mm;0,6;0,7\n1-16 mm;0,4;0,7\n")
    notice = "the class below 1 mm is not used, because the sieve curve has no mass there"
    assert notice in page.locator("#notices").inner_text()
    page = open_curve(open_page, table="FL;EL\n0,6;0,7\n")
    assert CHECK_BY_CLASS not in page.locator("#answer").inner_text()
    assert float(by_class.replace(",", ".")) > float(porosity(page).replace(",", "."))


@pytest.mark.parametrize(
    "table, message",
    [
        ("L,I\n40,30\n", "the column S is missing beside L, I"),
        ("class,FL,EL\n4-8 mm,0.6,0.7\n8-16 mm,0.5,0.7\n", "the class 2 to 4 mm has mass, but no class"),
        ("class,FL,EL\n2-8 mm,0.6,0.7\n4-16 mm,0.5,0.7\n", "the classes 2 to 8 mm and 4 to 16 mm overlap"),
    ],
)
def test_grains_that_do_not_suit_a_curve_are_refused(open_page, table, message):
    page = open_curve(open_page, table=table)
    assert message in page.locator("#error").inner_text()
    assert page.locator("#results").is_hidden()


def test_a_file_dropped_on_the_sieves_is_the_curve(open_page, tmp_path):
    path = tmp_path / "kies.csv"
    path.write_bytes("Siebweite [mm];Rückstand [%]\n16;0\n8;50,5\n4;30\nBoden;19,5\n".encode("cp1252"))
    page = open_curve(open_page, sieves="", finest="2")
    page.get_by_label("Open sieves").set_input_files(path)
    page.locator("#answer strong").wait_for()
    assert "kies.csv: the text is not UTF-8" in page.locator("#curve-notices").inner_text()
