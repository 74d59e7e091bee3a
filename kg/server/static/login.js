// A link `/login#token=...` logs in. The part after the # is never sent, so no log of a server or proxy contains it.

const given = new URLSearchParams(location.hash.slice(1)).get("token");
if (given) {
  history.replaceState(null, "", location.pathname + location.search);
  document.getElementById("token").value = given;
  document.getElementById("login").requestSubmit();
}
