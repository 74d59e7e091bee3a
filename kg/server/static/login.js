// A link `/login#token=...` logs in. The part after the # is never sent, so no log of a server or proxy contains it.

function follow() {
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (!given) return;
  history.replaceState(null, "", location.pathname + location.search);
  document.getElementById("token").value = given;
  document.getElementById("login").requestSubmit();
}

// The link may also be pasted while this page is open, which loads nothing.
window.addEventListener("hashchange", follow);
follow();
