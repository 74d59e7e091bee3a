"""Copies and references of C++ objects: a change of a copy does not affect the original."""

from __future__ import annotations

import pytest
from extract.cpp.packages import interfaces_of, texts_of

STRUCT = "struct S { std::string name; S() {} S(std::string n) : name(n) {} };"
MADE = 'S a; a.name = "x";'
COPIED = [
    ("of a declared type", 'S b = a; b.name = "y";'),
    ("constructed", 'S b(a); b.name = "y";'),
    ("in braces", 'S b{a}; b.name = "y";'),
    ("auto", 'auto b = a; b.name = "y";'),
    ("of a copy", 'auto b = a; auto c = b; c.name = "y";'),
    ("assigned", 'S b; b = a; b.name = "y";'),
    ("through a pointer", 'S* p = &a; S b = *p; b.name = "y";'),
    ("through a reference", 'S& r = a; auto b = r; b.name = "y";'),
    ("on the heap", 'auto b = std::make_shared<S>(a); b->name = "y";'),
    ("new", 'S* b = new S(a); b->name = "y";'),
    ("parameter", "by_value(a);"),
    ("element that is added", 'std::vector<S> v; v.push_back(a); v[0].name = "y";'),
    ("element that is set", 'std::map<std::string, S> v; v["k"] = a; v["k"].name = "y";'),
    ("returned", 'Holds h{a}; S b = h.get(); b.name = "y"; a = h.held;'),
    ("member of a copy", 'Holds h{a}; Holds b = h; b.held.name = "y"; a = h.held;'),
    ("element of a copied list", 'std::vector<S> v{a}; auto w = v; w[0].name = "y"; a = v[0];'),
    ("captured", 'auto f = [a]() mutable { a.name = "y"; }; f();'),
    ("captured by default", 'auto f = [=]() mutable { a.name = "y"; }; f();'),
    ("turn of a loop", 'std::vector<S> v{a}; for (auto s : v) { s.name = "y"; } a = v[0];'),
]
SHARED = [
    ("reference", 'S& b = a; b.name = "y";'),
    ("auto reference", 'auto& b = a; b.name = "y";'),
    ("pointer", 'S* b = &a; b->name = "y";'),
    ("auto pointer", 'auto b = &a; auto c = b; c->name = "y";'),
    ("parameter by reference", "by_reference(a);"),
    ("parameter by reference that is assigned", "assigns(a);"),
    ("parameter by pointer", "by_pointer(&a);"),
    ("assigned through a pointer", 'S* p = &a; *p = S("y");'),
    ("returned by reference", 'Refers h{a}; h.get().name = "y";'),
    ("captured by reference", 'auto f = [&a]() { a.name = "y"; }; f();'),
    ("shared pointer", 'auto p = std::make_shared<S>("x"); auto q = p; q->name = "y"; a = *p;'),
    ("assigned pointer", 'std::shared_ptr<S> q, p = std::make_shared<S>("x"); q = p; q->name = "y"; a = *p;'),
    ("pointer of a class", 'S::SharedPtr p = std::make_shared<S>("x"); S::SharedPtr q = p; q->name = "y"; a = *p;'),
    ("element that is a pointer", 'std::vector<S*> v; v.push_back(&a); auto p = v[0]; p->name = "y";'),
    ("copied list of pointers", 'std::vector<S*> v{&a}; auto w = v; w[0]->name = "y";'),
    ("turn of a loop by reference", 'std::vector<S> v{a}; for (auto& s : v) { s.name = "y"; } a = v[0];'),
    ("turn of a loop over pointers", 'std::vector<S*> v{&a}; for (auto s : v) { s->name = "y"; }'),
    ("pointer in a copied object", 'P o; o.to = &a; P b = o; b.to->name = "y";'),
]
OUTER = STRUCT + (
    "struct Holds { S held; S get() { return held; } };\nstruct P { S* to; };\n"
    "struct Refers { S& s; S& get() { return s; } };\n"
    'void by_value(S s) { s.name = "y"; }\nvoid by_reference(S& s) { s.name = "y"; }\n'
    'void by_pointer(S* s) { s->name = "y"; }\nvoid assigns(S& s) { s = S("y"); }\n'
)


@pytest.mark.parametrize(("label", "code"), COPIED, ids=[label for label, _ in COPIED])
def test_changes_of_a_copy_leave_the_original(label: str, code: str) -> None:
    """The fields of a copied object remain when the copy changes."""
    assert texts_of("a.name", MADE + code, OUTER) == {"x"}, label


@pytest.mark.parametrize(("label", "code"), SHARED, ids=[label for label, _ in SHARED])
def test_references_and_pointers_share_the_object(label: str, code: str) -> None:
    """A change through a reference or a pointer changes the object."""
    assert texts_of("a.name", MADE + code, OUTER) == {"y"}, label


def test_a_loop_by_reference_changes_the_elements() -> None:
    """An element that is a text changes with the reference to it."""
    local = 'std::vector<std::string> v{"x", "y"}; for (auto& s : v) { s += "_raw"; }'
    assert texts_of("v[0]", local) == {"x_raw"}


@pytest.mark.parametrize(
    "loop", ['for (std::string s : {"a", "b"}) {}', 'for (int k = 0; k < 2; ++k) { std::string s = "a"; }']
)
def test_variables_of_a_loop_hide_others(loop: str) -> None:
    """A hidden variable has its value again after the loop."""
    assert texts_of("s", f'std::string s = "x"; {loop}') == {"x"}


def test_callbacks_keep_what_they_capture_by_copy() -> None:
    """A callback registered in a loop runs with the values of each iteration."""
    local = (
        'for (std::string n : {"a", "b"}) { auto timer = nh.createTimer(ros::Duration(1), '
        "[n, &nh](const ros::TimerEvent&) { nh.advertise<std_msgs::String>(n, 1); }); }"
    )
    source = f"#include <ros/ros.h>\nint main(int argc, char** argv) {{ ros::NodeHandle nh; {local} ros::spin(); }}"
    assert {one.name for one in interfaces_of(source)} == {"a", "b"}


def test_an_object_of_one_side_of_a_branch_has_its_last_state_only() -> None:
    """The states of an object created in one branch are not alternatives."""
    local = 'S a("x"), c("z"); if (nh.ok()) { S b = a; b.name = "y"; c = b; }'
    assert texts_of("c.name", local, OUTER) == {"y", "z"}


def test_copied_qos_is_another_one() -> None:
    """A change of a copied quality of service does not affect the original."""
    source = (
        'int main() { auto node = rclcpp::Node::make_shared("n"); rclcpp::QoS q(1); auto r = q; r.best_effort();'
        ' node->create_publisher<std_msgs::msg::String>("t", q); }'
    )
    (found,) = interfaces_of(source)
    assert found.qos is not None
    assert found.qos.reliability == "reliable"


def test_an_object_that_holds_itself_is_copied_once() -> None:
    """A list of a class outside the build may contain the object that owns the list."""
    outer = "struct S { std::string name; std::vector<outside::Part> held; void fill() { held.push_back(this); } };"
    local = 'S a; a.name = "x"; a.fill(); S b = a; b.name = "y";'
    assert texts_of("a.name", local, outer) == {"x"}
    assert texts_of("b.name", local, outer) == {"y"}
