#pragma once

class Linear
{
};
